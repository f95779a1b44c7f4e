// SPDX-License-Identifier: Apache-2.0
#include "core/discrepancy/questions.h"

#include <array>

#include "core/algorithms/algorithms.h"

namespace graze {
namespace {

std::string indexed(std::string name) { return name; }
template <class... Index>
std::string indexed(std::string name, int i, Index... more) {
  return indexed(std::move(name) + "[" + std::to_string(i) + "]", more...);
}
std::string indexed(std::string name, int i, int j, const char* part) {
  return indexed(std::move(name), i, j) + "." + part;
}

// Collects the questions that an algorithm's `list` names.
struct List {
  std::vector<Question> questions;

  // The distances of b's vertices from a's plane, then of a's vertices from b's plane.
  void plane_distances() {
    for (const char* triangle : {"b", "a"}) {
      for (int i = 0; i < 3; ++i) value(Site::plane_distance, 3, triangle, i);
    }
  }
  template <class... Index>
  void value(Site site, int degree, const char* of, Index... index) {
    add_value(static_cast<int>(site), degree, indexed(of, index...));
  }
  template <class... Index>
  void own(int degree, const char* of, Index... index) {
    add_value(kSiteCount, degree, indexed(of, index...));
  }
  // The two questions of `overlap` in range.h.
  template <class... Index>
  void overlap(int degree, const char* axis, Index... index) {
    const std::string on = indexed(axis, index...);
    compare(degree, on, "a.high", "b.low", false);
    compare(degree, on, "b.high", "a.low", false);
  }
  // The questions of `contains` in interval_overlap.h. `of` is, for example, "b.low in a".
  void contained(int degree, const std::string& of) {
    const std::string point = of.substr(0, of.find(' ')), interval(1, of.back());
    compare(degree, of, interval + ".low", point, true);
    compare(degree, of, point, interval + ".high", true);
  }
  // The questions of plane_projection.h.
  void projections(int degree) {
    for (int i = 0; i < 3; ++i) {
      for (const char* axis : {"projected_edge_a", "projected_edge_b"}) overlap(degree, axis, i);
    }
  }

 private:
  void add_value(int site, int degree, const std::string& of) {
    std::string name = std::string(site_name(site)) + "." + of;
    questions.push_back({name, site, degree, {name}});
  }
  void compare(int degree, const std::string& on, const std::string& l, const std::string& r, bool at_most) {
    const std::string prefix = std::string(name(Site::separation)) + "." + on;
    questions.push_back({prefix + ": " + l + (at_most ? " <= " : " < ") + r,
                         static_cast<int>(Site::separation),
                         degree,
                         {prefix + "." + l, prefix + "." + r},
                         at_most});
  }
};

template <class... Algorithm>
std::array<std::vector<Question>, kAlgorithmCount> all_of(const std::tuple<Algorithm...>*) {
  const auto of = [](auto list) {
    List questions;
    list(questions);
    return questions.questions;
  };
  return {of([](List& list) { Algorithm::list(list); })...};
}

}  // namespace

std::string_view site_name(int site) { return site == kSiteCount ? "own" : name(static_cast<Site>(site)); }

const std::vector<Question>& questions_of(int algorithm) {
  static const auto all = all_of(static_cast<const Algorithms*>(nullptr));
  return all.at(static_cast<std::size_t>(algorithm));
}

std::vector<std::uint8_t> degrees_of(int algorithm) {
  std::vector<std::uint8_t> degrees;
  for (const Question& question : questions_of(algorithm))
    degrees.push_back(static_cast<std::uint8_t>(question.degree));
  return degrees;
}

}  // namespace graze
