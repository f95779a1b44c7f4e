// SPDX-License-Identifier: Apache-2.0
#include "subjects/published.h"

#include <fmt/format.h>

#include <string_view>

#include "core/fnv1a.h"
#include "subjects/source_build.h"

namespace graze::subjects {
namespace {

struct Header {
  std::string_view name, text;
};
constexpr Header kHeaders[] = {
#include "subjects/published_headers.inc"
};

constexpr std::string_view kSource = R"(// The published algorithm {}, as a lane runs it.
#include "core/algorithms/algorithms.h"

template <class Real>
int graze_published(const Real* p, const Real* q) {{
  const graze::Vec3<Real> a[3] = {{{{p[0], p[1], p[2]}}, {{p[3], p[4], p[5]}}, {{p[6], p[7], p[8]}}}};
  const graze::Vec3<Real> b[3] = {{{{q[0], q[1], q[2]}}, {{q[3], q[4], q[5]}}, {{q[6], q[7], q[8]}}}};
  const graze::Verdict verdict = std::tuple_element_t<{}, graze::Algorithms>::decide(a, b);
  return verdict == graze::Verdict::declined ? -1 : verdict == graze::Verdict::intersects;
}}
)";

// The header's text with includes relative to its own folder, so that no compiler flag is needed for the parent folder.
std::string text_of(const Header& header) {
  constexpr std::string_view kInclude = "#include \"core/";
  std::string up, text(header.text);
  for (const char c : header.name) up += c == '/' ? "../" : "";
  for (std::size_t at = text.find(kInclude); at != text.npos; at = text.find(kInclude, at + kInclude.size()))
    text.insert(at + kInclude.find("core/"), up);
  return text;
}

}  // namespace

std::vector<const Lane*> published_algorithms() {
  std::vector<const Lane*> found;
  for (const Lane& lane : published_lanes()) {
    if (found.empty() || found.back()->info != lane.info) found.push_back(&lane);
  }
  return found;
}

std::filesystem::path published_source(const Lane& lane) {
  std::uint64_t hash = fnv1a("");
  for (const Header& header : kHeaders) hash = fnv1a(text_of(header), fnv1a(header.name, hash));
  const std::filesystem::path folder = cache_folder() / fmt::format("published-{:016x}", hash);
  for (const Header& header : kHeaders) write_if_new(folder / header.name, text_of(header));
  const std::filesystem::path source = folder / fmt::format("{}.cpp", lane.info->id);
  write_if_new(source, fmt::format(kSource, lane.info->id, lane.algorithm));
  return source;
}

}  // namespace graze::subjects
