/* See touch.h. */
#include "touch.h"

#include <string.h>

int touch_mesh(const lumbrical_object* object, const lumbrical_settings* settings,
               const lumbrical_frame* frames, size_t count, lumbrical_output* outputs) {
  lumbrical_scene* scene = NULL;
  lumbrical_model* model = NULL;
  lumbrical_session* session = NULL;
  size_t i;
  int status = lumbrical_scene_create(LUMBRICAL_RIGHT, 0.19, &scene);
  if (status == LUMBRICAL_OK) status = lumbrical_scene_add_object(scene, object);
  if (status == LUMBRICAL_OK) status = lumbrical_scene_set_settings(scene, settings);
  if (status == LUMBRICAL_OK) status = lumbrical_model_build(scene, NULL, &model);
  lumbrical_scene_destroy(scene);
  if (status == LUMBRICAL_OK) status = lumbrical_session_create(model, &session);
  lumbrical_model_destroy(model);
  for (i = 0; i < count && status == LUMBRICAL_OK; ++i) {
    outputs[i].size = sizeof outputs[i];
    status = lumbrical_session_tick(session, &frames[i], NULL, 0, &outputs[i]);
  }
  lumbrical_session_destroy(session);
  return status;
}

/* As openxr.h declares them. */
typedef struct {
  uint64_t locationFlags;
  struct {
    struct {
      float x, y, z, w;
    } orientation;
    struct {
      float x, y, z;
    } position;
  } pose;
  float radius;
} XrHandJointLocationEXT;

typedef struct {
  int32_t type;
  void* next;
  uint32_t isActive;
  uint32_t jointCount;
  XrHandJointLocationEXT* jointLocations;
} XrHandJointLocationsEXT;

/* What lumbrical.h says of their offsets; C99 has no other assertion. */
#define ASSERT_OFFSET(struct_type, field, offset) \
  typedef char struct_type##_##field[offsetof(struct_type, field) == (offset) ? 1 : -1]
ASSERT_OFFSET(XrHandJointLocationsEXT, isActive, sizeof(void*) == 8 ? 16 : 8);
ASSERT_OFFSET(XrHandJointLocationsEXT, jointCount, sizeof(void*) == 8 ? 20 : 12);
ASSERT_OFFSET(XrHandJointLocationsEXT, jointLocations, sizeof(void*) == 8 ? 24 : 16);
ASSERT_OFFSET(XrHandJointLocationEXT, pose, 8);
ASSERT_OFFSET(XrHandJointLocationEXT, radius, 36);
typedef char location_size[sizeof(XrHandJointLocationEXT) == 40 ? 1 : -1];

static XrHandJointLocationsEXT locate(const lumbrical_joint* joints, uint32_t valid, int active, float radius,
                                      XrHandJointLocationEXT* places) {
  XrHandJointLocationsEXT hand;
  int j;
  for (j = 0; j < LUMBRICAL_JOINTS; ++j) {
    places[j].locationFlags = (valid >> j & 1u) != 0 ? 15 : 4;
    memcpy(&places[j].pose.position, joints[j].position, sizeof places[j].pose.position);
    memcpy(&places[j].pose.orientation, joints[j].orientation, sizeof places[j].pose.orientation);
    places[j].radius = radius;
  }
  hand.type = 1000051003;
  hand.next = NULL;
  hand.isActive = active ? 1 : 0;
  hand.jointCount = LUMBRICAL_JOINTS;
  hand.jointLocations = places;
  return hand;
}

int frame_by_openxr(const lumbrical_joint* joints, uint32_t valid, int active, lumbrical_frame* frame) {
  XrHandJointLocationEXT places[LUMBRICAL_JOINTS];
  const XrHandJointLocationsEXT hand = locate(joints, valid, active, 0.01f, places);
  return lumbrical_frame_from_openxr(&hand, frame);
}

int fit_by_openxr(lumbrical_scene* scene, const lumbrical_joint* joints, float radius) {
  XrHandJointLocationEXT places[LUMBRICAL_JOINTS];
  const XrHandJointLocationsEXT hand = locate(joints, ~0u, 1, radius, places);
  return lumbrical_scene_fit_hand(scene, &hand);
}
