// The engine inside a C# program: a scene file, a session, and one tick per frame.
//   mcs -unsafe Embed.cs ../../bindings/csharp/Lumbrical.cs && mono Embed.exe ../cup.json
using System;
using Lumbrical;
using static Lumbrical.Native;

static class Embed
{
    static void Check(int status)
    {
        if (status != (int)Status.Ok) throw new Exception(Text(lumbrical_message()));
    }

    static unsafe int Main(string[] arguments)
    {
        IntPtr scene, model, session;
        Check(lumbrical_scene_load(arguments.Length > 0 ? arguments[0] : "cup.json", out scene));
        Check(lumbrical_model_build(scene, IntPtr.Zero, out model));
        Check(lumbrical_session_create(model, out session));
        var frame = new Frame();
        var output = new Output { size = (uint)sizeof(Output) };
        Check(lumbrical_frame_init(ref frame));
        double strongest = 0;
        for (int i = 0; i < 1000; ++i)
        {
            Check(lumbrical_scene_frame(scene, i / 1000.0, ref frame));
            Check(lumbrical_session_tick(session, ref frame, IntPtr.Zero, UIntPtr.Zero, ref output));
            for (int s = 0; s < 16; ++s)
            {
                double* f = output.segment + 6 * s;
                strongest = Math.Max(strongest, Math.Sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
            }
        }
        UIntPtr count;
        lumbrical_session_contacts(session, null, UIntPtr.Zero, out count);  // how many there are
        var contacts = new Contact[(int)count + 1];
        contacts[0].size = (uint)sizeof(Contact);
        Check(lumbrical_session_contacts(session, contacts, (UIntPtr)contacts.Length, out count));
        Console.WriteLine(FormattableString.Invariant(
            $"strongest force on a segment: {strongest:F2} N; {(int)count} contacts at the end"));
        lumbrical_session_destroy(session);
        lumbrical_model_destroy(model);
        lumbrical_scene_destroy(scene);
        return strongest > 0 ? 0 : 1;
    }
}
