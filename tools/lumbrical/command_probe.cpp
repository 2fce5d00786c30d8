// lumbrical probe: what explicit primitives feel in a mesh, triangle by triangle. How anyone checks the
// mechanics against a reference of their own.
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commands.h"
#include "lumbrical/probe.h"
#include "output.h"
#include "switches.h"
#include "winding_text.h"

namespace lumbrical::tool {
namespace {

struct ProbeOptions {
  std::string mesh, unit;
  double stiffness = Settings{}.stiffness;
  std::string law{law_name(Law::field)}, precision = "exact";
  std::array<std::vector<std::string>, 3> primitives;  // as written, in the order of kSwitches
  bool json = false;
};

// "1,2,3,0.5" -> numbers; nothing where a part is not a finite number.
std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    double number = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    if (error != std::errc() || end != part.data() + part.size() || !std::isfinite(number))
      return std::nullopt;
    numbers.push_back(number);
    if (comma == std::string_view::npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

struct Switch {
  const char* name;
  const char* form;
  const char* help;
  ProbeShape shape;
  std::size_t fewest, most;  // numbers
};

constexpr Switch kSwitches[] = {
    {"--sphere", "x,y,z,r", "A sphere [m]; repeatable", ProbeShape::sphere, 4, 4},
    {"--cylinder", "x1,y1,z1,x2,y2,z2,r", "A cylinder with flat ends [m]; repeatable", ProbeShape::cylinder,
     7, 7},
    {"--capsule", "x1,y1,z1,x2,y2,z2,r1[,r2]",
     "A capsule [m], with two radii the hull of its end spheres; repeatable", ProbeShape::capsule, 7, 8},
};

// Refuses what is wrong by the name of its switch.
ProbePrimitive parse_primitive(const Switch& kind, const std::string& text) {
  const auto numbers = parse_numbers(text);
  if (!numbers || numbers->size() < kind.fewest || numbers->size() > kind.most) {
    refuse_option(kind.name, "\"" + text + "\" is not " + kind.form + " (finite numbers, metres)");
  }
  const std::vector<double>& n = *numbers;
  ProbePrimitive primitive;
  primitive.shape = kind.shape;
  primitive.end1 = {n[0], n[1], n[2]};
  primitive.end2 = kind.shape == ProbeShape::sphere ? primitive.end1 : Vec3{n[3], n[4], n[5]};
  primitive.radius1 = kind.shape == ProbeShape::sphere ? n[3] : n[6];
  primitive.radius2 = n.size() == 8 ? n[7] : primitive.radius1;
  if (!(primitive.radius1 > 0 && primitive.radius2 > 0)) {
    refuse_option(kind.name, "\"" + text + "\" has a radius that is not above 0");
  }
  return primitive;
}

// In the order of the command line, whatever their kinds: a contact names its primitive by this order.
std::vector<ProbePrimitive> parse_primitives(const Command& command, const ProbeOptions& options) {
  std::vector<ProbePrimitive> primitives;
  std::array<std::size_t, std::size(kSwitches)> used{};
  for (const std::string& name : command.given()) {
    for (std::size_t i = 0; i < std::size(kSwitches); ++i) {
      if (name != kSwitches[i].name) continue;
      primitives.push_back(parse_primitive(kSwitches[i], options.primitives[i].at(used[i]++)));
    }
  }
  if (primitives.empty()) demand_option("At least one of --sphere, --cylinder and --capsule");
  return primitives;
}

struct Total {
  double area = 0, volume = 0;
  Vec3 force;
};

Total sum(const std::vector<ProbeContact>& contacts) {
  Total total;
  for (const ProbeContact& contact : contacts) {
    total.area += contact.area;
    total.volume += contact.volume;
    total.force += contact.force;
  }
  return total;
}

Json contacts_json(const std::vector<ProbeContact>& contacts) {
  Json list = Json::array();
  for (const ProbeContact& contact : contacts) {
    Json entry;
    entry["triangle"] = contact.triangle;
    entry["primitive"] = contact.primitive;
    entry["depth"] = contact.depth;
    entry["area"] = contact.area;
    entry["centroid"] = to_json(contact.centroid);
    entry["volume"] = contact.volume;
    entry["volume_error"] = contact.error;
    entry["force"] = to_json(contact.force);
    entry["normal"] = to_json(contact.normal);
    entry["centre"] = to_json(contact.centre);
    list.push_back(std::move(entry));
  }
  const Total total = sum(contacts);
  Json json;
  json["contacts"] = std::move(list);
  json["total"] = {{"area", total.area}, {"volume", total.volume}, {"force", to_json(total.force)}};
  return json;
}

std::string cell(const std::string& text, std::size_t width = 12) {
  return std::string(text.size() < width ? width - text.size() : 1, ' ') + text;
}

std::string vector_cells(Vec3 v, double scale) {
  return cell(brief(scale * v.x, 5)) + cell(brief(scale * v.y, 5)) + cell(brief(scale * v.z, 5));
}

std::string contacts_text(const std::vector<ProbeContact>& contacts) {
  std::string text = "primitive    triangle   depth[mm]  area[mm^2] volume[mm^3]" + cell("centroid[mm]", 36) +
                     cell("force[N]", 36) + '\n';
  for (const ProbeContact& contact : contacts) {
    text += cell(std::to_string(contact.primitive), 9) + cell(std::to_string(contact.triangle)) +
            cell(brief(1e3 * contact.depth, 5)) + cell(brief(1e6 * contact.area, 5)) +
            cell(brief(1e9 * contact.volume, 5), 13) + vector_cells(contact.centroid, 1e3) +
            vector_cells(contact.force, 1) + '\n';
  }
  const Total total = sum(contacts);
  text += "total" + cell(std::to_string(contacts.size()), 16) + cell("", 12) +
          cell(brief(1e6 * total.area, 5)) + cell(brief(1e9 * total.volume, 5), 13) + std::string(36, ' ') +
          vector_cells(total.force, 1) + '\n';
  return text;
}

int probe_mesh(const ProbeOptions& options, const std::vector<ProbePrimitive>& primitives) {
  Mesh mesh;
  if (Status status = load_mesh(options.mesh, *parse_unit(options.unit), mesh); !status.ok()) {
    return fail(status);
  }
  std::vector<ProbeContact> contacts;
  Status status = probe(mesh, primitives, *parse_law(options.law), options.stiffness, contacts);
  if (!status.ok()) return fail(status);
  const WindingReport winding = wind_outwards(mesh);  // only to say what a scene would do
  if (winding.turned_triangles > 0)
    warn(options.mesh + ": a scene would have " + grouped(winding.turned_triangles) +
         " of its triangles turned outside out; here all are felt as the file has them");
  if (!options.json) return print_text(contacts_text(contacts));
  Json json = contacts_json(contacts);
  json["winding"] = to_json(winding);
  return print_json(json);
}

}  // namespace

void add_probe(Command& app, int& exit_code) {
  const auto options = std::make_shared<ProbeOptions>();
  Command* const command = app.add_subcommand("probe", "One static query: what primitives feel in a mesh");
  command->add_option("--mesh", options->mesh, "OBJ, STL, PLY, OFF or glTF file")->required();
  command->add_option("--unit", options->unit, "Unit of the file's numbers")->required()->check(is_unit());
  for (std::size_t i = 0; i < std::size(kSwitches); ++i) {
    command->add_option(kSwitches[i].name, options->primitives[i], kSwitches[i].help)
        ->type_name(kSwitches[i].form)
        ->repeatable();
  }
  command->add_option("--stiffness", options->stiffness, "K_s [N/m^3]")
      ->check(is_stiffness())
      ->capture_default_str();
  command->add_option("--law", options->law, "Contact law")->check(is_law())->capture_default_str();
  command->add_option("--precision", options->precision, "Any may be named: a probe is always exact")
      ->check(is_precision());
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, command, &exit_code] {
    exit_code = probe_mesh(*options, parse_primitives(*command, *options));
  });
}

}  // namespace lumbrical::tool
