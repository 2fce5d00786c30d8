// Mass, centre and inertia of the solid inside a mesh: see lumbrical/object.h.
#include <cassert>

#include "base/floating_point.h"
#include "lumbrical/object.h"

namespace lumbrical {
namespace {

/// Integrals over a solid of 1, of its coordinates and of their products.
struct SolidIntegrals {
  double volume = 0;
  Vec3 first;
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
};

// Over the tetrahedron from the origin to a triangle.
void add_tetrahedron(Vec3 a, Vec3 b, Vec3 c, SolidIntegrals& sums) {
  const double volume = dot(a, cross(b, c)) / 6;
  const Vec3 total = a + b + c;
  sums.volume += volume;
  sums.first += (volume / 4) * total;
  const auto product = [&](double Vec3::*i, double Vec3::*j) {
    return volume / 20 * (a.*i * a.*j + b.*i * b.*j + c.*i * c.*j + total.*i * total.*j);
  };
  sums.xx += product(&Vec3::x, &Vec3::x);
  sums.yy += product(&Vec3::y, &Vec3::y);
  sums.zz += product(&Vec3::z, &Vec3::z);
  sums.xy += product(&Vec3::x, &Vec3::y);
  sums.yz += product(&Vec3::y, &Vec3::z);
  sums.zx += product(&Vec3::z, &Vec3::x);
}

// Other callers have no such fields.
constexpr const char* kOrSay = "; or, in a scene file, give mass, centre and inertia";

// Why a mesh that is not watertight encloses no one solid, and what to do.
Status refuse_open(const MeshReport& report) {
  const auto count = [](std::size_t number, const char* what) {
    return std::to_string(number) + " " + what + (number == 1 ? " edge" : " edges");
  };
  if (report.boundary_edges > 0)
    return Status::error(
        "the mesh is not closed (" + count(report.boundary_edges, "open") +
        "), so what it weighs is unknown; close it (lumbrical inspect --fix closes what rounding "
        "tore)" +
        kOrSay);
  if (report.duplicate > 0)
    return Status::error("the mesh has " + std::to_string(report.duplicate) +
                         (report.duplicate == 1 ? " triangle" : " triangles") +
                         " twice, so what it weighs is unknown; leave the second ones out (lumbrical inspect "
                         "--fix does, of closed parts)" +
                         kOrSay);
  if (report.non_manifold_edges > 0)
    return Status::error("the mesh has " + count(report.non_manifold_edges, "non-manifold") +
                         ", of more than two triangles, so what it weighs is unknown; take out walls inside "
                         "it, or part solids that touch" +
                         kOrSay);
  return Status::error("the mesh has " + count(report.misoriented_edges, "misoriented") +
                       ", so what it weighs is unknown; wind it one way, as lumbrical inspect --fix does" +
                       kOrSay);
}

}  // namespace

Status mass_properties(const Mesh& mesh, double density, MassProperties& properties) {
  const FloatingPointGuard guard;
  if (!(density > 0 && density < 1e6)) return Status::error("a density must be above 0 and below 1e6 kg/m^3");
  const MeshReport report = inspect_mesh(mesh);
  if (!report.watertight) return refuse_open(report);
  const Vec3 middle = 0.5 * (report.lower + report.upper);  // keeps digits far from the origin
  SolidIntegrals sums;
  for (const Triangle& t : mesh.triangles)
    add_tetrahedron(mesh.vertices[t[0]] - middle, mesh.vertices[t[1]] - middle, mesh.vertices[t[2]] - middle,
                    sums);
  if (!(sums.volume > 0))
    return Status::error(
        std::string(
            "the mesh encloses no volume; if it is inside out, turn it over, as winding \"auto\" does") +
        kOrSay);
  const Vec3 c = sums.first / sums.volume;
  const double v = sums.volume;
  const double xx = sums.xx - v * c.x * c.x, yy = sums.yy - v * c.y * c.y, zz = sums.zz - v * c.z * c.z;
  properties.mass = density * v;
  properties.centre = middle + c;
  properties.inertia = {density * (yy + zz),
                        density * (zz + xx),
                        density * (xx + yy),
                        -density * (sums.xy - v * c.x * c.y),
                        -density * (sums.yz - v * c.y * c.z),
                        -density * (sums.zx - v * c.z * c.x)};
  return {};
}

void scale_to_mass(double mass, MassProperties& properties) {
  assert(mass > 0 && properties.mass > 0);
  const double share = mass / properties.mass;
  for (double& moment : properties.inertia) moment *= share;
  properties.mass = mass;
}

Status check_weight(Mobility mobility, double density, double mass) {
  const bool heavy = density != 0 || mass != 0;
  if (mobility == Mobility::fixed && heavy)
    return Status::error(
        "an object that stands still takes no density or mass: let it move, or leave both out");
  if (mobility == Mobility::given && !heavy) return {};
  if (mobility != Mobility::fixed && (!(density >= 0) || !(mass >= 0) || (density > 0) == (mass > 0)))
    return Status::error("an object that moves takes a density or a mass above 0, and 0 for the other");
  return {};
}

}  // namespace lumbrical
