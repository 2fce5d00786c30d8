// P/Invoke declarations of lumbrical.h, whose comments are the manual: structs, enumerations and functions have its
// names and its order, and a test holds the two against each other. Structs are blittable: nothing is copied or
// allocated in a call. Set `size` first, to (uint)sizeof(T), or by the functions ..._init. Compile with -unsafe.
// Beside `using System` write Lumbrical.Object, since System has an Object, too.
using System;
using System.Runtime.InteropServices;

namespace Lumbrical
{
    public enum Status
    {
        Ok = 0,
        BadArgument = 1,
        BadData = 2,
        TooSmall = 3,
        Busy = 4,
        NotRecorded = 5,
        Failed = 6,
    }

    public enum Side
    {
        FirstHand = -1,
        Left = 0,
        Right = 1,
    }

    public enum Law
    {
        Field = 0,
        Column = 1,
        MaxDepth = 2,
        Centroid = 3,
        Point = 4,
    }

    public enum FeltOnce
    {
        FeltOnceNever = 0,
        FeltOnceBySamples = 1,
        FeltOnceAlways = 2,
    }

    public enum Mobility
    {
        Fixed = 0,
        Given = 1,
        Free = 2,
        Hinge = 3,
        Slider = 4,
        Ball = 5,
    }

    public enum Unit
    {
        Metre = 0,
        Centimetre = 1,
        Millimetre = 2,
    }

    public enum Winding
    {
        WindingAutomatic = 0,
        WindingAsIs = 1,
        WindingFlip = 2,
    }

    public enum Broadphase
    {
        SearchAutomatic = 0,
        SearchTree = 1,
        SearchGrid = 2,
        SearchVoxel = 3,
        SearchBrute = 4,
    }

    public enum Input
    {
        JointPoses = 0,
        JointAngles = 1,
    }

    public enum Convention
    {
        Openxr = 0,
        Unity = 1,
        Unreal = 2,
    }

    public enum Quantity
    {
        Position = 0,
        Direction = 1,
        Rotation = 2,
    }

    public enum FrameFlag
    {
        TrackingLost = 1,
        Extrapolated = 2,
    }

    public enum OutputFlag
    {
        InputNotFinite = 1,
        InputImplausible = 2,
        InputLost = 4,
        InputExtrapolated = 8,
        SegmentMissing = 16,
        SegmentDegenerate = 32,
        AngleClamped = 64,
        CandidateOverflow = 128,
        ForceLimited = 256,
        Fading = 512,
        Coarsened = 1024,
        ObjectMissing = 2048,
        ObjectImplausible = 4096,
        MemoryForeign = 8192,
        HandJumped = 16384,
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Pose
    {
        public fixed double position[3];
        public fixed double orientation[4];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Wrench
    {
        public fixed double force[3];
        public fixed double torque[3];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Joint
    {
        public fixed float position[3];
        public fixed float orientation[4];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Texture
    {
        public IntPtr grey;
        public uint width;
        public uint height;
        public double period;
        public double black;
        public double white;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Object
    {
        public uint size;
        public int mobility;
        public int convention;
        public int unit;
        public int winding;
        public int reserved;
        public IntPtr name;
        public IntPtr mesh_file;
        public IntPtr vertices;
        public IntPtr float_vertices;
        public UIntPtr vertex_count;
        public IntPtr triangles;
        public UIntPtr triangle_count;
        public Pose pose;
        public double static_friction;
        public double kinetic_friction;
        public double viscosity;
        public double shear_stiffness;
        public double density;
        public double mass;
        public double damping;
        public fixed double pivot[3];
        public fixed double axis[3];
        public double lower;
        public double upper;
        public double spring;
        public double rest;
        public double dry_friction;
        public double detent_force;
        public double detent_pitch;
        public int has_latch;
        public uint latch_object;
        public double latch_opens;
        public double crease_angle;
        public IntPtr friction_factors;
        public Texture grip;
        public Texture bumps;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Settings
    {
        public uint size;
        public uint effort;
        public uint max_candidates;
        public int has_ground;
        public fixed int law[16];
        public fixed double precision[16];
        public double stiffness;
        public double rate;
        public double point_area;
        public double max_force;
        public double fade_time;
        public double proxy_stiffness;
        public fixed double pad_from[2];
        public fixed double pad_stiffness[2];
        public double pad_damping;
        public fixed double gravity[3];
        public fixed double ground_normal[3];
        public double ground_offset;
        public double ground_friction;
        public int felt_once;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Execution
    {
        public uint size;
        public int broadphase;
        public uint threads;
        public uint leaf_size;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct ModelInfo
    {
        public uint size;
        public int side;
        public uint object_count;
        public uint apart_count;
        public uint given_count;
        public int broadphase;
        public ulong triangle_count;
        public double rate;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Frame
    {
        public uint size;
        public int kind;
        public uint flags;
        public uint valid;
        public Pose @base;
        public fixed float joint[182];
        public fixed float angle[20];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Output
    {
        public uint size;
        public uint flags;
        public ulong tick;
        public uint contact_count;
        public uint object_count;
        public ulong evaluations;
        public double error_estimate;
        public double force_error;
        public fixed double hand_force[3];
        public fixed double segment[96];
        public fixed double joint_torque[48];
        public fixed double flexion_torque[16];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct Contact
    {
        public uint size;
        public uint segment;
        public uint @object;
        public uint triangle;
        public double depth;
        public double area;
        public fixed double centroid[3];
        public fixed double centre[3];
        public fixed double normal[3];
        public fixed double force[3];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct ObjectOutput
    {
        public uint size;
        public uint @object;
        public Pose pose;
        public Wrench wrench;
        public double coordinate;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct RecordOptions
    {
        public uint size;
        public int live;
        public uint force_interval;
        public uint reserved;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct RecordingInfo
    {
        public uint size;
        public int complete;
        public int side;
        public int hands;
        public ulong ticks;
        public ulong first_tick;
        public ulong last_tick;
        public ulong missing_ticks;
        public double seconds;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct ReplayResult
    {
        public uint size;
        public int identical;
        public ulong ticks;
        public ulong tick;
        public fixed byte stage[32];
        public fixed byte field[64];
        public fixed byte recorded[64];
        public fixed byte replayed[64];
        public fixed byte damage[256];
    }

    public static class Native
    {
        const string Library = "lumbrical";
        const CallingConvention C = CallingConvention.Cdecl;

        // What lumbrical_message and the other functions that give a text answer.
        public static string Text(IntPtr text)
        {
            return Marshal.PtrToStringAnsi(text);
        }

        [DllImport(Library, CallingConvention = C)]
        public static extern IntPtr lumbrical_version();
        [DllImport(Library, CallingConvention = C)]
        public static extern IntPtr lumbrical_message();
        [DllImport(Library, CallingConvention = C)]
        public static extern IntPtr lumbrical_joint_name(int joint);
        [DllImport(Library, CallingConvention = C)]
        public static extern IntPtr lumbrical_segment_name(int segment);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_object_init(ref Object @object);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_settings_init(ref Settings settings);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_execution_init(IntPtr execution);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_frame_init(ref Frame frame);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_create(int side, double hand_length, out IntPtr scene);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_load(string path, out IntPtr scene);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_destroy(IntPtr scene);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_add_object(IntPtr scene, ref Object @object);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_settings(IntPtr scene, ref Settings settings);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_set_settings(IntPtr scene, ref Settings settings);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_set_radii(IntPtr scene, [In, Out] double[] radii);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_fit_hand(IntPtr scene, IntPtr xr_hand_joint_locations);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_seconds(IntPtr scene, out double seconds);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_scene_frame(IntPtr scene, double time, ref Frame frame);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_model_build(IntPtr scene, IntPtr execution, out IntPtr model);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_model_share(IntPtr world, IntPtr hand, out IntPtr model);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_model_destroy(IntPtr model);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_model_describe(IntPtr model, ref ModelInfo info);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_model_object_name(IntPtr model, uint @object, out IntPtr name);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_create(IntPtr model, out IntPtr session);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_destroy(IntPtr session);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_tick(IntPtr session, ref Frame frame, IntPtr given, UIntPtr given_count, ref Output output);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_contacts(IntPtr session, [In, Out] Contact[] contacts, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_objects(IntPtr session, [In, Out] ObjectOutput[] objects, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_joints(IntPtr session, [In, Out] Pose[] joints);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_jacobians(IntPtr session, uint segments, [In, Out] double[] values, out uint known);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_save(IntPtr session, IntPtr bytes, UIntPtr capacity, out UIntPtr size);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_restore(IntPtr session, IntPtr bytes, UIntPtr size);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_hash(IntPtr session, out ulong hash);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_record(IntPtr session, string path, IntPtr options);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_session_stop_recording(IntPtr session, out ulong kept);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_replay(string path, string world, IntPtr execution, ref ReplayResult result);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_reader_open(string path, int side, out IntPtr reader);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_reader_close(IntPtr reader);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_reader_describe(IntPtr reader, ref RecordingInfo info);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_reader_model(IntPtr reader, string world, IntPtr execution, out IntPtr model);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_reader_next(IntPtr reader, ref Frame frame, ref Output output, out int end);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_reader_objects(IntPtr reader, [In, Out] ObjectOutput[] objects, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_reader_given(IntPtr reader, [In, Out] Pose[] given, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_reader_seek(IntPtr reader, ulong tick);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_frame_from_openxr(IntPtr xr_hand_joint_locations, ref Frame frame);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_convert_vectors(int @from, int to, int quantity, [In, Out] double[] xyz, UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_convert_poses(int @from, int to, [In, Out] Pose[] poses, UIntPtr count);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_convert_frame(int @from, int to, ref Frame frame);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_convert_output(int @from, int to, ref Output output);
        [DllImport(Library, CallingConvention = C)]
        public static extern int lumbrical_convert_contacts(int @from, int to, [In, Out] Contact[] contacts, UIntPtr count);
    }
}
