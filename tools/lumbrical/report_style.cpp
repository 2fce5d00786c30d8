// See report_style.h.
#include "report_style.h"

namespace lumbrical::tool {

const char* const kPlotColours = R"(:root {
  --back: #fff; --text: #1c2126; --weak: #59636e; --grid: #dfe3e8; --front: #1c2126;
  --s0: #1f66b5; --s1: #c4501b; --s2: #27824a; --s3: #8446ad; --s4: #967000; --s5: #bd3377; --s6: #55606b; --s7: #0b8088;
}
@media (prefers-color-scheme: dark) {
  :root {
    --back: #14181c; --text: #e4e8ec; --weak: #9aa5b0; --grid: #2d343b; --front: #e4e8ec;
    --s0: #6fb1f5; --s1: #f08a5d; --s2: #6ccf8b; --s3: #c79af0; --s4: #e3bd4d; --s5: #f283b6; --s6: #a9b6c2; --s7: #57cdd2;
  }
}
)";

const char* const kPlotMarks = R"(svg text { fill: var(--weak); font-size: 11px; }
svg .title { fill: var(--text); font-size: 13px; font-weight: 600; }
svg .x { text-anchor: middle; }
svg .y { text-anchor: end; }
.grid { stroke: var(--grid); }
.zero { stroke: var(--weak); stroke-dasharray: 2 3; }
.point { stroke: var(--back); stroke-width: 0.7; }
.ring { fill: none; stroke: var(--front); stroke-width: 1.4; }
.staircase { fill: none; stroke: var(--front); stroke-width: 1; stroke-dasharray: 5 3; opacity: 0.6; }
.line { fill: none; stroke-width: 1.6; }
.deadline { stroke: var(--s1); stroke-dasharray: 6 3; }
svg text.deadline { stroke: none; fill: var(--s1); }
.leader { stroke: var(--weak); stroke-width: 0.6; }
svg .name { fill: var(--text); font-size: 10px; stroke: var(--back); stroke-width: 2.5px; paint-order: stroke; }
svg .left { text-anchor: end; }
.plain { fill: var(--weak); }
.bars { min-width: 46rem; }
.s0.point { fill: var(--s0); } .s0.line { stroke: var(--s0); }
.s1.point { fill: var(--s1); } .s1.line { stroke: var(--s1); }
.s2.point { fill: var(--s2); } .s2.line { stroke: var(--s2); }
.s3.point { fill: var(--s3); } .s3.line { stroke: var(--s3); }
.s4.point { fill: var(--s4); } .s4.line { stroke: var(--s4); }
.s5.point { fill: var(--s5); } .s5.line { stroke: var(--s5); }
.s6.point { fill: var(--s6); } .s6.line { stroke: var(--s6); }
.s7.point { fill: var(--s7); } .s7.line { stroke: var(--s7); }
)";

}  // namespace lumbrical::tool
