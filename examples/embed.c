/* The engine inside a C program: a scene file, a session, and one tick per frame.
 * cc -std=c99 embed.c -llumbrical -lm && ./a.out cup.json */
#include <lumbrical.h>
#include <math.h>
#include <stdio.h>

static int complain(void) {
  fprintf(stderr, "%s\n", lumbrical_message());
  return 1;
}

int main(int argc, char** argv) {
  lumbrical_scene* scene = NULL;
  lumbrical_model* model = NULL;
  lumbrical_session* session = NULL;
  lumbrical_frame frame;
  lumbrical_output output = {.size = sizeof output};
  double strongest = 0;

  if (lumbrical_scene_load(argc > 1 ? argv[1] : "cup.json", &scene)) return complain();
  if (lumbrical_model_build(scene, NULL, &model)) return complain();
  if (lumbrical_session_create(model, &session)) return complain();
  if (lumbrical_frame_init(&frame)) return complain();

  for (int i = 0; i < 1000; ++i) { /* a tracker would deliver these frames; here the scene's motion does */
    if (lumbrical_scene_frame(scene, i / 1000.0, &frame)) return complain();
    if (lumbrical_session_tick(session, &frame, NULL, 0, &output)) return complain();
    for (int s = 0; s < LUMBRICAL_SEGMENTS; ++s) {
      const double* f = output.segment[s].force;
      strongest = fmax(strongest, sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
    }
  }
  printf("strongest force on a segment: %.2f N\n", strongest);

  lumbrical_session_destroy(session);
  lumbrical_model_destroy(model);
  lumbrical_scene_destroy(scene);
  return strongest > 0 ? 0 : 1;
}
