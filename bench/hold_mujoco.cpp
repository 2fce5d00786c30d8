// MuJoCo 2: fingertips as in hold_bullet.cpp. As it comes, and set against creep as its manual advises.
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "hold.h"

namespace lumbrical::bench {
namespace {

struct MujocoHold {
  mjModel* model = nullptr;
  mjData* data = nullptr;
  std::vector<Vec3> felt;
  Vec3 weight;  // of the held body; the fingers carry their own
  MujocoHold() = default;
  MujocoHold(const MujocoHold&) = delete;
  MujocoHold& operator=(const MujocoHold&) = delete;
  ~MujocoHold() {
    mj_deleteData(data);
    mj_deleteModel(model);
  }
  // The held body has the first seven coordinates and six speeds, each fingertip three of both.
  void step(std::span<const Vec3> tips) {
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const double* const x = data->qpos + 7 + 3 * i;
      const double* const v = data->qvel + 6 + 3 * i;
      const double damping = 2 * std::sqrt(kCoupling * kTipMass);
      const Vec3 pull = kCoupling * (tips[i] - Vec3{x[0], x[1], x[2]}) - damping * Vec3{v[0], v[1], v[2]};
      double* const force = data->qfrc_applied + 6 + 3 * i;
      force[0] = pull.x;
      force[1] = pull.y;
      force[2] = pull.z;
      felt[i] = -pull;
    }
    data->qfrc_applied[0] = weight.x;
    data->qfrc_applied[1] = weight.y;
    data->qfrc_applied[2] = weight.z;
    mj_step(model, data);
  }
};

std::string text_of(const HeldBody& body, std::span<const Vec3> tips, const char* options) {
  std::ostringstream text;
  text.precision(17);
  const double twist = body.friction * kTwistRadius;
  text << "<mujoco><option timestep=\"" << kHoldTick << "\" gravity=\"0 0 0\" " << options
       << "/><default><geom condim=\"4\" friction=\"" << body.friction << ' ' << twist
       << " 0\"/></default><worldbody><body><freejoint/><geom mass=\"" << body.mass << "\" ";
  if (body.cylinder)
    text << "type=\"cylinder\" size=\"" << body.half.x << ' ' << body.half.z << "\"";
  else
    text << "type=\"box\" size=\"" << body.half.x << ' ' << body.half.y << ' ' << body.half.z << "\"";
  text << "/></body>";
  for (const Vec3 tip : tips) {
    text << "<body><joint type=\"slide\" axis=\"1 0 0\"/><joint type=\"slide\" axis=\"0 1 0\"/>"
         << "<joint type=\"slide\" axis=\"0 0 1\"/><geom type=\"sphere\" size=\"" << kTipRadius
         << "\" mass=\"" << kTipMass << "\"/></body>";
    static_cast<void>(tip);
  }
  text << "</worldbody></mujoco>";
  return text.str();
}

std::shared_ptr<MujocoHold> make_hold(const HeldBody& body, std::span<const Vec3> tips, const char* options) {
  const std::string text = text_of(body, tips, options);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "hold.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  const auto hold = std::make_shared<MujocoHold>();
  char error[1000] = "";
  hold->model = mj_loadXML("hold.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (hold->model == nullptr) throw std::runtime_error(error);
  hold->data = mj_makeData(hold->model);
  hold->felt.resize(tips.size());
  hold->weight = body.mass * body.gravity;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    double* const x = hold->data->qpos + 7 + 3 * i;
    x[0] = tips[i].x;
    x[1] = tips[i].y;
    x[2] = tips[i].z;
  }
  return hold;
}

HoldEngine engine(const char* name, const char* options) {
  return {name, [options](const HeldBody& body, std::span<const Vec3> tips) {
            const auto hold = make_hold(body, tips, options);
            return Holder{[hold](std::span<const Vec3> now) { hold->step(now); },
                          [hold] {
                            const double* const q = hold->data->qpos;
                            return Pose{{q[0], q[1], q[2]}, {q[3], q[4], q[5], q[6]}};
                          },
                          [hold](std::size_t finger) { return hold->felt[finger]; }};
          }};
}

}  // namespace

void add_mujoco_holders(std::vector<HoldEngine>& engines) {
  engines.push_back(engine("MuJoCo 2.2.2, as it comes", ""));
  engines.push_back(engine("MuJoCo 2.2.2, elliptic cones, impratio 100, noslip",
                           "cone=\"elliptic\" impratio=\"100\" noslip_iterations=\"20\""));
}

}  // namespace lumbrical::bench
