#include "lumbrical/surface_file.h"

#include <utility>

#include "base/text_cursor.h"
#include "base/whole_file.h"

namespace lumbrical {
namespace {

struct ImageReader {
  std::string_view content;
  const std::string& name;
  TextCursor cursor;
  std::int64_t white = 0;  ///< the brightest grey
  [[nodiscard]] Status error(const std::string& what) const { return text_error(name, cursor.place(), what); }
};

Status read_number(ImageReader& reader, const char* what, std::int64_t low, std::int64_t high,
                   std::int64_t& value) {
  const std::string_view word = reader.cursor.word_across_lines();
  if (word.empty())
    return reader.error("the file ends before " + std::string(what) + "; save the image again");
  if (read_integer(word, value) && value >= low && value <= high) return {};
  return reader.error(std::string(what) + " is " + in_quotes(word) + ", no whole number of " +
                      std::to_string(low) + " to " + std::to_string(high) + "; save the image again");
}

std::uint16_t grey_of(std::int64_t value, std::int64_t white) {
  return static_cast<std::uint16_t>((value * 65535 + white / 2) / white);
}

Status read_plain(ImageReader& reader, GreyImage& image) {
  for (std::uint16_t& grey : image.grey) {
    std::int64_t value = 0;
    if (Status status = read_number(reader, "a grey", 0, reader.white, value); !status.ok()) return status;
    grey = grey_of(value, reader.white);
  }
  return {};
}

Status read_raw(ImageReader& reader, GreyImage& image) {
  const std::size_t bytes = reader.white < 256 ? 1 : 2;
  std::size_t at = reader.cursor.offset() + 1;  // one blank
  for (std::uint16_t& grey : image.grey) {
    std::int64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i)
      value = 256 * value + static_cast<unsigned char>(reader.content[at++]);
    if (value > reader.white)
      return Status::error(reader.name + ": byte " + std::to_string(at - bytes) + ": a grey of " +
                           std::to_string(value) + " is brighter than white, " +
                           std::to_string(reader.white) + "; save the image again");
    grey = grey_of(value, reader.white);
  }
  return {};
}

Status parse(ImageReader& reader, GreyImage& image) {
  const std::string_view kind = reader.cursor.word_across_lines();
  if (kind != "P2" && kind != "P5")
    return reader.error("is no PGM image, which starts with P2 or P5; convert it (magick IMAGE out.pgm)");
  constexpr auto kMost = static_cast<std::int64_t>(kMostTexels);
  std::int64_t width = 0, height = 0;
  if (Status status = read_number(reader, "the width", 1, kMost, width); !status.ok()) return status;
  if (Status status = read_number(reader, "the height", 1, kMost / width, height); !status.ok())
    return status;
  if (Status status = read_number(reader, "white", 1, 65535, reader.white); !status.ok()) return status;
  const bool plain = kind == "P2";
  const auto texels = static_cast<std::size_t>(width * height);
  // Of a plain image each texel takes a digit and a blank, of a raw one the first blank stands before them.
  const std::size_t needed = plain ? 2 * texels : texels * (reader.white < 256 ? 1 : 2) + 1;
  if (reader.cursor.remaining() < needed)
    return reader.error("the file ends before the last of its " + std::to_string(texels) +
                        " texels; save the image again");
  image.width = static_cast<std::uint32_t>(width);
  image.height = static_cast<std::uint32_t>(height);
  image.grey.resize(texels);
  return plain ? read_plain(reader, image) : read_raw(reader, image);
}

}  // namespace

Status parse_grey_image(std::string_view content, const std::string& name, GreyImage& image) {
  ImageReader reader{content, name, TextCursor(content, {.hash_comments = true})};
  GreyImage parsed;
  if (Status status = parse(reader, parsed); !status.ok()) return status;
  image = std::move(parsed);
  return {};
}

Status load_grey_image(const std::string& path, GreyImage& image) {
  std::string content;
  if (Status status = read_whole_file(path, kSmallFile, "a PGM image", content); !status.ok()) return status;
  return parse_grey_image(content, shown_name(path), image);
}

Status parse_friction_factors(std::string_view content, const std::string& name,
                              std::vector<double>& factors) {
  TextCursor cursor(content, {.hash_comments = true});
  std::vector<double> parsed;
  for (std::string_view word = cursor.word_across_lines(); !word.empty(); word = cursor.word_across_lines()) {
    double factor = 0;
    if (const char* const fault = read_finite(word, factor))
      return text_error(name, cursor.place(), "friction factor " + in_quotes(word) + " " + fault);
    if (!(factor >= 0 && factor <= 10))
      return text_error(name, cursor.place(),
                        "friction factor " + in_quotes(word) + " is out of range; give 0 to 10");
    if (parsed.size() == kMostTexels)
      return text_error(name, cursor.place(), "more than 4194304 friction factors; simplify the mesh");
    parsed.push_back(factor);
  }
  factors = std::move(parsed);
  return {};
}

Status load_friction_factors(const std::string& path, std::vector<double>& factors) {
  std::string content;
  if (Status status = read_whole_file(path, kSmallFile, "a text file of numbers", content); !status.ok())
    return status;
  return parse_friction_factors(content, shown_name(path), factors);
}

}  // namespace lumbrical
