/* What the tests of lumbrical.h do in C99. */
#ifndef TOUCH_H
#define TOUCH_H

#include "lumbrical.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A right hand on a mesh: every frame a tick. Returns the first status that is not LUMBRICAL_OK. */
int touch_mesh(const lumbrical_object* object, const lumbrical_settings* settings,
               const lumbrical_frame* frames, size_t count, lumbrical_output* outputs);

/* OpenXR's struct of a hand, filled with these joints, given to lumbrical_frame_from_openxr. */
int frame_by_openxr(const lumbrical_joint* joints, uint32_t valid, int active, lumbrical_frame* frame);

/* And to lumbrical_scene_fit_hand, all joints with one radius. */
int fit_by_openxr(lumbrical_scene* scene, const lumbrical_joint* joints, float radius);

#ifdef __cplusplus
}
#endif

#endif
