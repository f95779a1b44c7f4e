// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "core/text.h"
#include "reports/possible_counts.h"

namespace graze::reports {

using Json = nlohmann::ordered_json;
namespace {

// The shapes by name, as in reports/web/src/report.ts. An object must have the given fields. A '?' after a field's name
// makes it optional, and "*" means all fields. All elements of a list have one shape; with "some", the list must not be
// empty. A '?' after a shape allows null. A "positive count" is not 0. Other words are names of shapes in this table.
constexpr const char* kShapes = R"({
"share": {"count": "count", "of": "count", "share": "number?", "low": "number?", "high": "number?"},
"threshold": {"exponent": "whole?", "above": "count", "bound": "number", "largest": "whole?"},
"errors": {"pairs": "count", "false_positive": "count", "false_negative": "count", "declined": "count"},
"policy_errors": {"policy": "text", "pairs": "count", "false_positive": "count", "false_negative": "count",
  "declined": "count", "fixed": "count", "broken": "count"},
"quartiles": {"low": "number", "middle": "number", "high": "number"},
"at_scale": {"log2": "whole", "from": "policy_errors", "errors": "policy_errors"},
"tuned": {"lane": "text", "forbid": "text", "max_rate": "number", "max_other": "number",
  "chosen": "text", "result": "text", "bound": "number", "other_bound": "number", "confirmed": "policy_errors",
  "zero_confirmed": "policy_errors", "dead": ["text"],
  "scale_break": {"up?": "at_scale", "down?": "at_scale"},
  "interactions": [{"first": "policy_errors", "second": "policy_errors", "together": "policy_errors"}],
  "lanes_left_out?": "left_out", "epsilon?": {"name": "text", "written": "text", "value?": "number", "file": "text", "lines": ["count"],
    "chosen": "text", "units?": "text"},
  "zero": "policy_errors", "curves": [{"site": "text", "tolerance": "text", "points": ["policy_errors", "some"]}],
  "sentences": ["text", "some"]},
"left_out": {"patterns": ["text"], "why": {"*": "text"}},
"pareto": {"pairs": "count", "seed": "count", "machine": "text", "lanes_left_out?": "left_out",
  "lanes": [{"lane": "text", "errors": "errors", "bound": "number", "in_cache?": "quartiles",
    "from_memory?": "quartiles", "one_a_call?": "quartiles", "resident?": "quartiles", "with_copies?": "quartiles",
    "dominated": "yes or no",
    "registers?": "count", "local_bytes?": "count", "active_threads?": "count", "failure": "text?"}, "some"],
  "not_timed?": [{"lane": "text", "errors": "errors", "bound": "number", "failure": "text?", "why": "text"}],
  "extremes": [{"lane": "text", "extreme": "text", "says": "text", "points": [{"log2": "whole", "pairs": "count",
    "false_positive": "count", "false_negative": "count", "declined": "count"}]}],
  "sentences": ["text"]},
"costs": {"report?": "text", "machine": "text", "passes": "positive count",
  "rows": [{"lane": "count", "group": "count?", "pairs": "positive count", "low": "number", "middle": "number",
    "high": "number"}, "some"], "answer": ["text", "some"]},
"run": {"seed": "count", "pairs": "count", "complete": "yes or no", "command": "text", "map_command": "text",
  "build": {"version": "text", "commit": "text", "compiler": "text", "cuda": "text?", "device": "text?"},
  "scene?": "text?", "machine": "text?", "subjects?": [{"name": "text", "what": "text", "hash": "text",
    "source_hash?": "text", "compiler?": "text", "flags?": ["text"], "environment?": {"*": "text"},
    "contraction?": {"*": {"f32": "plan", "f64": "plan"}}}]},
"plan": {"plan": "text", "operations": "count"},
"kind": {"key": "text", "subject": "text", "cause": "text", "line": "text", "shape": "text", "pairs": "count",
  "intersecting": "count", "signatures": "count", "lanes": ["text"], "settled": ["count"], "strata": {"*": "count"},
  "margins": {"*": "count"},
  "worst": {"case": "text", "pair": "text", "from": "text", "margin_ulps": "number"}},
"labelled": {"label": "text", "text": "text"},
"card": {"kind": "kind", "file": "text", "minimised": "yes or no", "from": "text",
  "coordinates": "text", "pair": {"decimal": ["text"], "hex": ["text"], "value": ["number"]},
  "truth": {"verdict": "text", "contact": "text", "margin": "number", "margin_ulps": "number"},
  "drawing": {"contact": [["number"]], "planes_line": [["number"]]},
  "verdicts": [{"lane": "count", "verdict": "text", "wrong": "yes or no"}], "sentences": ["text"], "maps": "maps?",
  "commands": ["labelled"], "snippets": ["labelled"]},
"maps": {"title": "text", "x": "text", "y": "text", "size": "count", "legend": [{"colour": "text", "means": "text"}],
  "panels": [{"name": "text", "shows?": "text", "png": "text"}]},
"toolchain_map": {"reference": "text", "variants": ["text"],
  "rows": [{"algorithm": "text", "scalar": "text",
    "cells": [{"variant": "count", "lane": "count", "differs": "share?", "wrong": "share"}]}],
  "agree": [["text"]], "sentences": ["text"]},
"changed_kind": {"key": "text", "signatures": "count", "count": "count"},
"compare": {"other": "run", "headline": "text", "differences": ["text"],
  "rates": [{"lane": "text", "stratum": "text", "before": "share", "after": "share", "changed": "yes or no",
    "unseen?": "number?",
    "errors": [{"error": "text", "before": "share", "after": "share"}]}],
  "gained": ["changed_kind"], "lost": ["changed_kind"], "kinds_compared": "yes or no",
  "verdicts?": "changed_verdicts?"},
"changed_verdicts": [{"lane": "text", "stratum": "text", "pairs": "count", "known": "text", "least": "count",
  "most": "count", "broken?": "count", "mended?": "count", "smallest_broken?": "text", "smallest_mended?": "text"}],
"report": {"format": "count", "run": "run",
  "strata": [{"id": "text", "describes": "text", "pairs": "count", "intersects": "count"}],
  "lanes": [{"id": "text", "algorithm": "text", "scalar": "text", "target": "text", "paper": "text",
    "evidence": "text?", "exact": "yes or no"}],
  "answer": ["text"], "groups": [{"id": "text", "describes": "text", "strata": ["count"]}],
  "rates": [{"lane": "count", "stratum": "count?", "false_positive": "share", "false_negative": "share",
    "wrong": "share", "declined": "count", "differs_from_cpu": "share?", "crashed?": "count", "timed_out?": "count",
    "unstable?": "count", "by_convention?": "count", "stored?": "count"}, "some"],
  "group_rates": [{"lane": "count", "group": "count", "wrong": "share",
  "false_positive?": "share", "false_negative?": "share"}],
  "side_by_side": [{"kind": "text", "left": "count", "right": "count",
    "strata": [{"stratum": "count?", "left_wrong": "share", "right_wrong": "share", "differs": "share?"}]}],
  "toolchains?": "toolchain_map?",
  "margins": [{"lane": "count", "stratum": "count?",
    "points": [{"side": "text", "exponent": "whole?", "wrong": "share", "differs?": "share"}]}],
  "thresholds": [{"lane": "count", "group": "count?", "stratum": "count?", "disjoint": "threshold",
    "intersects": "threshold"}],
  "extremes": [{"kind": "text", "step": "count", "lane": "count", "origin": "whole?", "says": "text",
    "cells": [{"exponent": "whole", "wrong": "share", "times?": ["number?"]}]}],
  "signature_count": "count",
  "signatures": [{"key": "text", "algorithm": "text", "count": "count", "share": "number", "contact": "text",
    "dimensions": "text", "coplanar": "yes or no", "margin": "text", "marks": "text", "cards": ["count"],
    "nesting?": "text", "pairs": ["text"]}],
  "sources": {"*": "text"}, "cards": ["card"], "missing": ["text"], "compare": "compare?"}
})";

// Throws: std::runtime_error. place: JSON pointer to the value in the file.
void expect(const Json& shapes, const Json& shape, const Json& value, const std::string& place) {
  const auto refuse = [&](const std::string& expected) {
    throw std::runtime_error(fmt::format("expected {} at {}, found {}", expected, place.empty() ? "/" : place,
                                         shown(value.dump(-1, ' ', true, Json::error_handler_t::replace))));
  };
  if (shape.is_array()) {
    if (!value.is_array()) refuse("a list");
    if (shape.size() > 1 && value.empty()) refuse("a list that is not empty");
    for (std::size_t i = 0; i < value.size(); ++i) expect(shapes, shape[0], value[i], fmt::format("{}/{}", place, i));
    return;
  }
  if (shape.is_object()) {
    if (!value.is_object()) refuse("an object");
    for (const auto& [key, inner] : shape.items()) {
      if (key == "*") {
        for (const auto& [name, each] : value.items()) expect(shapes, inner, each, place + "/" + name);
        continue;
      }
      const bool optional = key.ends_with('?');
      const std::string name = key.substr(0, key.size() - optional);
      if (value.contains(name)) {
        expect(shapes, inner, value[name], place + "/" + name);
      } else if (!optional) {
        refuse("a field " + name);
      }
    }
    return;
  }
  std::string word = shape;
  if (word.ends_with('?')) {
    if (value.is_null()) return;
    word.pop_back();
  }
  if (shapes.contains(word)) return expect(shapes, shapes[word], value, place);
  const bool fits = word == "text"             ? value.is_string()
                    : word == "count"          ? value.is_number_unsigned()
                    : word == "positive count" ? value.is_number_unsigned() && value > 0
                    : word == "whole"          ? value.is_number_integer()
                    : word == "number"         ? value.is_number()
                                               : value.is_boolean();
  if (!fits) refuse(word == "yes or no" ? word : "a " + word + (word == "whole" ? " number" : ""));
}

}  // namespace

void expect_shape(const Json& value, const std::string& shape) {
  static const Json shapes = Json::parse(kShapes);
  expect(shapes, shape, value, "");
}

}  // namespace graze::reports
