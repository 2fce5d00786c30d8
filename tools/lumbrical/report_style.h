// What the classes in the report's pictures look like, s0 .. s7 and the rest: CSS for a page, or for a
// picture of its own.
#pragma once

namespace lumbrical::tool {

extern const char* const kPlotColours;  ///< variables, light and dark; they come first
extern const char* const kPlotMarks;    ///< what is drawn with them

}  // namespace lumbrical::tool
