// lumbrical.h against what liblumbrical.so shows, and against the declarations for C#.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <memory>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "files.h"
#include "lumbrical.h"
#include "tick/field_lists.h"

namespace lumbrical::test {
namespace {

const std::string kRoot = LUMBRICAL_SOURCE_DIR;

std::string header() {
  return std::regex_replace(read_file(kRoot + "/engine/include/lumbrical.h"),
                            std::regex(R"(/\*[^*]*\*+([^/*][^*]*\*+)*/)"), "");
}

std::string csharp() {
  return std::regex_replace(read_file(kRoot + "/bindings/csharp/Lumbrical.cs"), std::regex("//[^\n]*|@"), "");
}

// The pattern's matches: every one's groups.
std::vector<std::vector<std::string>> find_all(const std::string& text, const std::string& pattern) {
  std::vector<std::vector<std::string>> found;
  const std::regex expression(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it)
    found.emplace_back(it->begin(), it->end());
  return found;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) {
    part = std::regex_replace(part, std::regex("^\\s+|\\s+$"), "");
    if (!part.empty()) parts.push_back(std::regex_replace(part, std::regex("\\s+"), " "));
  }
  return parts;
}

std::string camel(const std::string& name) {
  std::string result;
  bool start = true;
  for (const char c : name) {
    if (c != '_') result += static_cast<char>(start ? std::toupper(c) : std::tolower(c));
    start = c == '_';
  }
  return result;
}

struct Function {
  std::string result, name;
  std::vector<std::string> arguments;
};

std::vector<Function> functions() {
  std::vector<Function> result;
  for (const auto& match :
       find_all(header(), R"(LUMBRICAL_API\s+([\w ]+?\*?)\s*(lumbrical_\w+)\(([^)]*)\);)"))
    result.push_back(
        {match[1], match[2], match[3] == "void" ? std::vector<std::string>{} : split(match[3], ',')});
  return result;
}

TEST(CApiDeclarations, TheLibraryShowsItsFunctionsAndNothingElse) {
  const std::string command = std::string("nm -D --defined-only '") + LUMBRICAL_SHARED_LIBRARY + "'";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::set<std::string> shown, declared;
  char line[4096];
  while (std::fgets(line, sizeof line, pipe.get()) != nullptr) {
    std::istringstream words(line);
    std::string address, kind, name;
    words >> address >> kind >> name;
    if (kind != "A") shown.insert(name.substr(0, name.find('@')));  // A: the name of the version
  }
  for (const Function& function : functions()) declared.insert(function.name);
  EXPECT_GT(declared.size(), 40u);
  EXPECT_EQ(shown, declared);
}

TEST(CApiDeclarations, TheLibraryNamesTheVersionItIsCompatibleWith) {
  const std::string command = std::string("objdump -p '") + LUMBRICAL_SHARED_LIBRARY + "' | grep SONAME";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  char line[256] = "";
  ASSERT_NE(std::fgets(line, sizeof line, pipe.get()), nullptr);
  const std::string version = lumbrical_version();
  EXPECT_NE(std::string(line).find("liblumbrical.so." + version.substr(0, version.rfind('.')) + "\n"),
            std::string::npos)
      << line;
}

// ---- C#

TEST(CApiDeclarations, CSharpHasTheSameEnumerations) {
  std::map<std::string, std::vector<std::string>> theirs;
  for (const auto& match : find_all(csharp(), R"(public enum (\w+)\s*\{([^}]*)\})"))
    theirs[match[1]] = split(match[2], ',');
  std::size_t enums = 0;
  for (const auto& match : find_all(header(), R"(enum lumbrical_(\w+) \{([^}]*)\};)")) {
    std::vector<std::string> expected;
    for (const auto& item : find_all(match[2], R"(LUMBRICAL_(\w+) = (-?\d+))"))
      expected.push_back(camel(item[1]) + " = " + item[2]);
    EXPECT_EQ(theirs[camel(match[1])], expected) << match[1];
    ++enums;
  }
  EXPECT_EQ(enums, theirs.size());
}

// ---- Settings, which each interface tells in words of its own

TEST(CApiDeclarations, EverySettingOfTheEngineIsToldByEveryInterface) {
  const auto part = [](const std::string& file, const char* from, const char* to) {
    const std::string text = read_file(kRoot + file);
    const std::size_t start = text.find(from);
    EXPECT_NE(start, std::string::npos) << file;
    return text.substr(start, text.find(to, start) - start);
  };
  // Each way of telling it, and what stands before a setting's name there. C# is held against lumbrical.h.
  const std::pair<std::string, const char*> told[] = {
      {part("/engine/include/lumbrical.h", "struct lumbrical_settings {", "}"), "[^.]\\b"},
      {part("/engine/src/capi/scene.cpp", "void to_c(const Scene&", "Fault to_scene"), "\\bout[.]"},
      {part("/engine/src/capi/scene.cpp", "Fault to_scene(", "Fault build"), "\\bgiven[.]"},
      {part("/bindings/python/scene.cpp", "void bind_scene", "PyModel"), "\""},
      {part("/bindings/python/lumbrical/__init__.pyi", "class Scene:", "class Model:"), "\\b"}};
  int count = 0;
  const Settings settings;
  list_fields(settings, [&](const std::string& name, const char*, const auto&) {
    ++count;
    for (const auto& [text, before] : told)
      EXPECT_TRUE(std::regex_search(text, std::regex(before + name + "(_\\w+)?\\b"))) << name << " in\n"
                                                                                      << text;
  });
  EXPECT_GE(count, 10);
}

using Fields = std::vector<std::string>;  // "name type count", nested structs as what they are made of

std::string field(const std::string& name, const std::string& type, std::size_t count) {
  return name + " " + type + " " + std::to_string(count);
}

std::size_t count_of(const std::string& dimensions) {
  std::size_t count = 1;
  for (const auto& match : find_all(dimensions, R"(\[(\w+)\])")) {
    const std::string& text = match[1];
    count *= text == "LUMBRICAL_JOINTS"     ? LUMBRICAL_JOINTS
             : text == "LUMBRICAL_SEGMENTS" ? LUMBRICAL_SEGMENTS
             : text == "LUMBRICAL_ANGLES"   ? LUMBRICAL_ANGLES
                                            : std::stoul(text);
  }
  return count;
}

std::map<std::string, Fields> structs_of_header() {
  const std::map<std::string, std::string> number = {
      {"uint32_t", "uint"}, {"int32_t", "int"},    {"uint64_t", "ulong"}, {"double", "double"},
      {"float", "float"},   {"size_t", "UIntPtr"}, {"char", "byte"}};
  const std::map<std::string, std::pair<std::string, std::size_t>> nested = {
      {"lumbrical_pose", {"double", 7}},
      {"lumbrical_wrench", {"double", 6}},
      {"lumbrical_joint", {"float", 7}},
      {"lumbrical_texture", {"Texture", 1}}};
  std::map<std::string, Fields> structs;
  for (const auto& match :
       find_all(header(), R"(typedef struct lumbrical_\w+ \{([^}]*)\} lumbrical_(\w+);)")) {
    Fields& fields = structs[camel(match[2])];
    for (const std::string& line : split(match[1], ';')) {
      const auto parts = find_all(line, R"(^(?:const )?(\w+)(\*?) (.*)$)");
      for (const std::string& item : split(parts.at(0)[3], ',')) {
        const std::string name = item.substr(0, item.find('['));
        const std::string& type = parts[0][1];
        if (!parts[0][2].empty()) {
          fields.push_back(field(name, "IntPtr", 1));
        } else if (nested.contains(type)) {
          fields.push_back(field(name, nested.at(type).first, nested.at(type).second * count_of(item)));
        } else {
          fields.push_back(field(name, number.at(type), count_of(item)));
        }
      }
    }
  }
  return structs;
}

std::map<std::string, Fields> structs_of_csharp() {
  std::map<std::string, Fields> structs;
  const std::map<std::string, std::pair<std::string, std::size_t>> nested = {{"Pose", {"double", 7}},
                                                                             {"Wrench", {"double", 6}}};
  for (const auto& match : find_all(csharp(), R"(public unsafe struct (\w+)\s*\{([^}]*)\})")) {
    Fields& fields = structs[match[1]];
    for (const auto& item : find_all(match[2], R"(public (?:fixed )?(\w+) (\w+)((?:\[\w+\])?);)")) {
      const bool whole = nested.contains(item[1]);
      fields.push_back(whole ? field(item[2], nested.at(item[1]).first, nested.at(item[1]).second)
                             : field(item[2], item[1], count_of(item[3])));
    }
  }
  return structs;
}

TEST(CApiDeclarations, CSharpHasTheSameStructs) {
  const auto ours = structs_of_header();
  EXPECT_GT(ours.size(), 12u);
  EXPECT_EQ(ours, structs_of_csharp());
  EXPECT_EQ(ours.at("Frame").size(), 7u);
}

// What a C type may be in C#.
bool fits(const std::string& c, const std::string& cs) {
  static const std::vector<std::pair<std::string, std::string>> kPairs = {
      {R"((const )?lumbrical_(scene|model|session|reader)\*)", "IntPtr"},
      {R"(lumbrical_(scene|model|session|reader)\*\*)", "out IntPtr"},
      {R"(const char\*)", "string"},
      {R"(const char\*\*)", "out IntPtr"},
      {R"((const )?void\*)", "IntPtr"},
      {"int32_t", "int"},
      {"uint32_t", "uint"},
      {"uint64_t", "ulong"},
      {"double", "double"},
      {"size_t", "UIntPtr"},
      {R"(size_t\*)", "out UIntPtr"},
      {R"(int32_t\*)", "out int"},
      {R"(uint32_t\*)", "out uint"},
      {R"(uint64_t\*)", "out ulong"},
      {R"((const )?double\*)", R"(out double|\[In, Out\] double\[\])"}};
  for (const auto& [ours, theirs] : kPairs)
    if (std::regex_match(c, std::regex(ours))) return std::regex_match(cs, std::regex(theirs));
  const auto name = find_all(c, R"(^(const )?lumbrical_(\w+)\*$)");
  if (name.empty()) return false;
  const std::string type = camel(name[0][2]);
  return cs == "ref " + type || cs == "[In, Out] " + type + "[]" || cs == "IntPtr";  // may be null
}

TEST(CApiDeclarations, CSharpHasTheSameFunctions) {
  std::map<std::string, Function> theirs;
  for (const auto& match : find_all(csharp(), R"(public static extern (\w+) (\w+)\(([^)]*)\);)")) {
    const std::string arguments = std::regex_replace(match[3], std::regex(R"(\[In, Out\])"), "[In; Out]");
    theirs[match[2]] = {match[1], match[2], split(arguments, ',')};
  }
  const auto parts = [](const std::string& argument) {
    const auto match =
        find_all(std::regex_replace(argument, std::regex("In; Out"), "In, Out"), R"(^(.*[ *])(\w+)$)");
    return std::pair(std::regex_replace(match.at(0)[1], std::regex(" +$"), ""), match[0][2]);
  };
  const auto ours = functions();
  EXPECT_EQ(ours.size(), theirs.size());
  for (const Function& function : ours) {
    ASSERT_TRUE(theirs.contains(function.name)) << function.name;
    const Function& other = theirs[function.name];
    EXPECT_EQ(other.result, function.result == "const char*" ? "IntPtr" : function.result) << function.name;
    ASSERT_EQ(other.arguments.size(), function.arguments.size()) << function.name;
    for (std::size_t i = 0; i < other.arguments.size(); ++i) {
      const auto [c, name] = parts(function.arguments[i]);
      const auto [cs, their_name] = parts(other.arguments[i]);
      EXPECT_EQ(name, their_name) << function.name;
      EXPECT_TRUE(fits(c, cs)) << function.name << ": " << c << " is not " << cs;
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
