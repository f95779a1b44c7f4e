// SPDX-License-Identifier: Apache-2.0
#include "analysis/ulp_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <type_traits>

#include "analysis/lane_trace.h"
#include "core/lanes/verdicts.h"
#include "oracle/truth.h"
#include "strata/draws.h"

namespace graze::analysis {
namespace {

// Computes the cells of the truth and of the lanes for blocks of pairs of one coordinate type.
template <class Real>
class Panels {
 public:
  using PairOf = BasicPair<Real>;

  explicit Panels(std::span<const Lane* const> lanes)
      : lanes_{find_lane(std::is_same_v<Real, float> ? "exact/f32/cpu" : "exact/f64/cpu")} {
    for (const Lane* lane : lanes) {
      if (!is_never_wrong(*lane, PairOf{})) lanes_.push_back(lane);
    }
    for (const Lane* lane : lanes_) blocks_.push_back(block_of(*lane));
    failed_.resize(blocks_.size());
  }

  const std::vector<const Lane*>& lanes() const { return lanes_; }  // the first lane gives the truth

  // Foreign code that fails on too many pairs gets no panel, because each failure takes a new process or the full time
  // limit.
  bool given_up(std::size_t panel) const { return failed_[panel] >= kMostFailures; }

  // Appends the cells of these pairs to each panel that is not given up.
  void judge(std::span<const PairOf> pairs, std::span<std::vector<Cell>> cells) {
    std::vector<Cell>& truth = cells.front();
    const std::size_t first = truth.size();
    for (const Verdict said : verdicts_of(blocks_.front(), pairs)) {
      truth.push_back(said == Verdict::declined     ? Cell::not_finite
                      : said == Verdict::intersects ? Cell::intersects
                                                    : Cell::disjoint);
    }
    for (std::size_t p = 1; p < blocks_.size(); ++p) {
      if (!ask(p, pairs)) continue;
      for (std::size_t i = 0; i < pairs.size(); ++i) cells[p].push_back(cell_of(said_[i], truth[first + i]));
    }
  }

 private:
  static constexpr int kMostFailures = 3000, kOfALate = 1000;  // a time-out counts as 1000, so three are enough

  static Cell cell_of(Verdict said, Cell truth) {
    if (truth == Cell::not_finite) return truth;
    switch (said) {
      case Verdict::intersects:
        return truth == Cell::intersects ? truth : Cell::false_positive;
      case Verdict::disjoint:
        return truth == Cell::disjoint ? truth : Cell::false_negative;
      case Verdict::declined:
        return Cell::declined;
      case Verdict::crashed:
        return Cell::crashed;
      case Verdict::timed_out:
        return Cell::timed_out;
      case Verdict::unstable:
        break;
    }
    return Cell::unstable;
  }

  // Runs the panel's lane on the pairs.
  // Returns: false if the panel is given up.
  bool ask(std::size_t p, std::span<const PairOf> pairs) {
    said_.clear();
    while (said_.size() < pairs.size()) {
      if (given_up(p)) return false;
      const bool prompt = !said_.empty() && failed_[p] == 0;
      const std::size_t at_once = lanes_[p]->foreign ? foreign_at_once(prompt) : pairs.size();
      const auto some = pairs.subspan(said_.size(), std::min(at_once, pairs.size() - said_.size()));
      for (const Verdict said : verdicts_seen_by(*lanes_[p], blocks_[p], some)) {
        said_.push_back(said);
        failed_[p] += said == Verdict::timed_out ? kOfALate : is_failure(said) ? 1 : 0;
      }
    }
    return true;
  }

  std::vector<const Lane*> lanes_;
  std::vector<DecideBlock> blocks_;
  std::vector<int> failed_;
  std::vector<Verdict> said_;  // the verdicts of one panel's lane
};

// Throws: OracleMismatch.
template <class Real>
void confirm(const UlpMap& map, const BasicPair<Real>& middle, int cell) {
  const int column = cell % kMapSize, row = cell / kMapSize;
  const BasicPair<Real> pair = pair_at(middle, map.moved, column, row);
  if (!is_finite(pair)) return;
  const Cell found = map.panels.front().cells[static_cast<std::size_t>(cell)];
  const bool intersects = found == Cell::intersects;
  if ((oracle::cgal_verdict(pair) == Verdict::intersects) == intersects &&
      (oracle::gmp_contact(pair) != Contact::none) == intersects)
    return;
  throw oracle::OracleMismatch(
      fmt::format("the exact decision and the oracle differ in column {}, row {} of an ulp map over {} and {}", column,
                  row, name_of_coordinate(map.moved.x), name_of_coordinate(map.moved.y)));
}

}  // namespace

std::string name_of_coordinate(int coordinate) {
  return fmt::format("{}[{}].{}", coordinate < 9 ? 'a' : 'b', coordinate / 3 % 3, "xyz"[coordinate % 3]);
}

std::optional<int> coordinate_of_name(std::string_view name) {
  for (int c = 0; c < kCoordinates; ++c) {
    if (name_of_coordinate(c) == name) return c;
  }
  return std::nullopt;
}

std::array<int, kCellKinds> UlpPanel::counts() const {
  std::array<int, kCellKinds> counts{};
  for (const Cell cell : cells) ++counts[static_cast<std::size_t>(cell)];
  return counts;
}

template <class Real>
BasicPair<Real> pair_at(const BasicPair<Real>& pair, MovedCoordinates moved, int column, int row) {
  BasicPair<Real> result = pair;
  const auto move = [&](int coordinate, int ulps) {
    Real& c = coordinates(result)[coordinate];
    if (ulps != 0) c = strata::nudged(c, ulps);  // a step of zero would turn -0 into +0
  };
  move(moved.x, column - kMapCentre);
  move(moved.y, kMapCentre - row);
  return result;
}

template Pair pair_at(const Pair&, MovedCoordinates, int, int);
template DoublePair pair_at(const DoublePair&, MovedCoordinates, int, int);

namespace {

template <class Real>
MovedCoordinates liveliest_of(const BasicPair<Real>& pair, std::span<const Lane* const> lanes) {
  // Columns and rows at distances of 2^k from the middle, on both sides.
  std::vector<int> places{kMapCentre};
  for (int away = 1; away < kMapCentre; away *= 2) {
    places.insert(places.begin(), kMapCentre - away);
    places.push_back(kMapCentre + away);
  }
  const std::size_t side = places.size();
  Panels<Real> panels(lanes);
  MovedCoordinates best{0, 1};
  std::tuple<bool, std::size_t, std::size_t> most{};
  for (int vertex = 0; vertex < kCoordinates; vertex += 3) {
    for (const MovedCoordinates& moved :
         {MovedCoordinates{vertex, vertex + 1}, {vertex, vertex + 2}, {vertex + 1, vertex + 2}}) {
      std::vector<BasicPair<Real>> pairs;
      for (const int row : places) {
        for (const int column : places) pairs.push_back(pair_at(pair, moved, column, row));
      }
      std::vector<std::vector<Cell>> cells(panels.lanes().size());
      panels.judge(pairs, cells);
      std::size_t across = 0, down = 0;
      for (const std::vector<Cell>& panel : cells) {
        for (std::size_t i = 0; i < panel.size(); ++i) {
          across += i % side > 0 && panel[i] != panel[i - 1];
          down += i >= side && panel[i] != panel[i - side];
        }
      }
      const bool by_zero = coordinates(pair)[moved.x] == 0 || coordinates(pair)[moved.y] == 0;
      const std::size_t fewer = std::min(across, down);
      const std::tuple changes{fewer > 0 && !by_zero, fewer, across + down};
      if (changes <= most) continue;
      most = changes;
      best = moved;
    }
  }
  return best;
}

template <class Real>
UlpMap map_of(const BasicPair<Real>& pair, std::span<const Lane* const> lanes, MovedCoordinates moved) {
  if (!is_finite(pair)) throw std::invalid_argument("expected finite coordinates for an ulp map");
  constexpr int kRowsAtOnce = 4;
  Panels<Real> panels(lanes);
  std::vector<std::vector<Cell>> cells(panels.lanes().size());
  std::vector<BasicPair<Real>> pairs;
  for (int row = 0; row < kMapSize; row += kRowsAtOnce) {
    pairs.clear();
    for (int i = 0; i < kRowsAtOnce * kMapSize; ++i)
      pairs.push_back(pair_at(pair, moved, i % kMapSize, row + i / kMapSize));
    panels.judge(pairs, cells);
  }
  UlpMap map{pair, moved, {}};
  for (std::size_t p = 0; p < cells.size(); ++p) {
    if (panels.given_up(p)) continue;
    map.panels.push_back({p > 0 ? panels.lanes()[p] : nullptr, std::move(cells[p])});
  }
  confirm(map, pair, kMapCentre * kMapSize + kMapCentre);
  for (int first = 0, k = 0; first < kMapSize * kMapSize; first += kMapSample, ++k)
    confirm(map, pair, first + 389 * k % kMapSample);  // a different column each time
  return map;
}

}  // namespace

MovedCoordinates liveliest_coordinates(const AnyPair& pair, std::span<const Lane* const> lanes) {
  return visit(pair, [&](const auto& own) { return liveliest_of(own, lanes); });
}

UlpMap ulp_map(const AnyPair& pair, std::span<const Lane* const> lanes, MovedCoordinates moved) {
  return visit(pair, [&](const auto& own) { return map_of(own, lanes, moved); });
}

}  // namespace graze::analysis
