// SPDX-License-Identifier: Apache-2.0
// Makes snippets of pairs with arbitrary bits and names. The vertices in the text must equal the pair's, bit for bit.
#include "reports/snippet.h"

#include <cstdlib>
#include <string>
#include <vector>

#include "core/fuzz_pair.h"
#include "core/fuzz_target.h"

namespace graze::reports {
namespace {

// If the line starts with `begins`, appends its numbers.
void read_numbers(std::string_view line, std::string_view begins, std::vector<float>& numbers) {
  if (!line.starts_with(begins)) return;
  const std::string text(line.substr(begins.size()));
  const char* at = text.c_str();
  for (int i = 0; i < 3; ++i) {
    char* end = nullptr;
    numbers.push_back(std::strtof(at, &end));
    must_hold(end != at, "a vertex's line has three numbers");
    at = end;
    while (*at == 'f' || *at == ',' || *at == ' ') ++at;
  }
}

bool is_vertex(std::string_view line) {
  return line.find("f,  // a[") != line.npos || line.find("f,  // b[") != line.npos;
}

std::vector<float> numbers_in(SnippetKind kind, std::string_view text) {
  std::vector<float> numbers;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (kind == SnippetKind::obj) {
      read_numbers(line, "v ", numbers);
    } else if (kind == SnippetKind::python) {
      for (const std::string_view begins : {"A = (\"", "B = (\"", "     \""}) read_numbers(line, begins, numbers);
    } else if (is_vertex(line)) {
      read_numbers(line, "    ", numbers);
    }
  }
  return numbers;
}

const RegisterFuzzTarget kSnippet("snippet", [](std::string_view bytes) {
  if (bytes.empty()) return;
  const auto kind = static_cast<SnippetKind>(static_cast<unsigned char>(bytes[0]) % std::size(kSnippetKinds));
  bytes.remove_prefix(1);
  const Pair pair = finite_pair_of(bytes);
  const Lane* shown = nullptr;
  for (const Lane& lane : lanes()) {
    if (!shown && shows(kind, lane)) shown = &lane;
  }
  const std::string name(bytes.substr(std::min<std::size_t>(bytes.size(), 73)));
  const std::string text = snippet(kind, {name, pair, Verdict::disjoint, shown, Verdict::intersects});
  const std::vector<float> numbers = numbers_in(kind, text);
  must_hold(numbers.size() == kCoordinates, "a snippet has the coordinates of one pair");
  must_hold(std::memcmp(numbers.data(), coordinates(pair), sizeof pair) == 0, "a snippet's bits are the pair's");
  for (int i = 0; i < kCoordinates; ++i) reached(static_cast<std::size_t>(std::ilogb(coordinates(pair)[i]) & 511));
  reached(512 + static_cast<std::size_t>(kind));
});

}  // namespace
}  // namespace graze::reports
