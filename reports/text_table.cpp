// SPDX-License-Identifier: Apache-2.0
#include "reports/text_table.h"

#include <algorithm>
#include <numeric>

namespace graze::reports {
namespace {

constexpr int kBetween = 2;  // spaces between columns

enum class Headers { whole, broken, steps };

std::string spaces(int count) { return std::string(static_cast<std::size_t>(std::max(count, 0)), ' '); }

// "guigue_devillers_2003" as "guigue", "devillers", "2003"; "moller_1997/f32" as "moller", "1997/", "f32".
std::vector<std::string> broken(const std::string& header) {
  std::vector<std::string> lines(1);
  for (const char c : header) {
    if (c != ' ' && c != '_') lines.back() += c;
    if (c == ' ' || c == '_' || c == '/') lines.emplace_back();
  }
  return lines;
}

int fraction_of(const std::string& text) {
  const std::size_t point = text.find('.');
  return point == text.npos ? 0 : width_of(text) - static_cast<int>(point);
}

class Printer {
 public:
  Printer(const std::vector<Column>& columns, const std::vector<std::vector<Cell>>& rows, const Screen& screen,
          int indent)
      : columns_(columns), screen_(screen), indent_(indent), cells_(rows) {
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      int fraction = 0, width = 0;
      for (const auto& row : cells_) fraction = std::max(fraction, fraction_of(row[c].text));
      for (auto& row : cells_) {
        if (columns_[c].align == Align::point) row[c].text += spaces(fraction - fraction_of(row[c].text));
        width = std::max(width, width_of(row[c].text));
      }
      cell_widths_.push_back(width);
    }
  }

  std::string all() const {
    std::vector<std::size_t> every(columns_.size());
    std::iota(every.begin(), every.end(), std::size_t{0});
    for (const Headers headers : {Headers::whole, Headers::broken, Headers::steps}) {
      if (fits(every, headers)) return block(every, headers);
    }
    std::vector<std::vector<std::size_t>> blocks = in_blocks(columns_.size());
    const std::size_t even = (columns_.size() - 1 + blocks.size() - 1) / blocks.size();
    const std::vector<std::vector<std::size_t>> evened = in_blocks(even);
    std::string text;
    for (const auto& some : evened.size() == blocks.size() ? evened : blocks)
      text += (text.empty() ? "" : "\n") + block(some, fits(some, Headers::whole) ? Headers::whole : Headers::broken);
    return text;
  }

 private:
  // Splits the columns into blocks of as many columns as fit, but at most `most` besides the first.
  std::vector<std::vector<std::size_t>> in_blocks(std::size_t most) const {
    std::vector<std::vector<std::size_t>> blocks;
    for (std::size_t next = 1; next < columns_.size(); ++next) {
      if (!blocks.empty() && blocks.back().size() <= most) {
        blocks.back().push_back(next);
        if (fits(blocks.back(), Headers::broken)) continue;
        blocks.back().pop_back();
      }
      blocks.push_back({0, next});
    }
    return blocks;
  }

  // Whether the header is wider than its cells, and therefore printed as a step.
  bool is_step(std::size_t c, Headers headers) const {
    return headers == Headers::steps && width_of(columns_[c].header) > cell_widths_[c] && c > 0;
  }

  int width(std::size_t c, Headers headers) const {
    int widest = cell_widths_[c];
    if (is_step(c, headers)) return widest;
    if (headers != Headers::broken || c == 0) return std::max(widest, width_of(columns_[c].header));
    for (const std::string& line : broken(columns_[c].header)) widest = std::max(widest, width_of(line));
    return widest;
  }

  // The width of the first column. A step's text is right-aligned with its column and extends over the columns to its
  // left, so it may widen the first column.
  int width_of_first(const std::vector<std::size_t>& some, Headers headers) const {
    int first = width(some[0], headers), before = 0;
    for (std::size_t i = 1; i < some.size(); ++i) {
      before += kBetween + width(some[i], headers);
      if (is_step(some[i], headers)) first = std::max(first, width_of(columns_[some[i]].header) - before);
    }
    return first;
  }

  bool fits(const std::vector<std::size_t>& some, Headers headers) const {
    int total = indent_ + width_of_first(some, headers);
    for (std::size_t i = 1; i < some.size(); ++i) total += kBetween + width(some[i], headers);
    return total <= screen_.columns;
  }

  std::string padded(const std::string& text, int width, Align align) const {
    const std::string pad = spaces(width - width_of(text));
    return align == Align::left ? text + pad : pad + text;
  }

  std::string block(const std::vector<std::size_t>& some, Headers headers) const {
    std::vector<int> widths, ends;  // ends: the position where each column ends
    for (const std::size_t c : some) {
      widths.push_back(widths.empty() ? width_of_first(some, headers) : width(c, headers));
      ends.push_back((ends.empty() ? indent_ : ends.back() + kBetween) + widths.back());
    }
    std::string result;
    const auto add_header = [&](const std::string& text) {
      result += bold(screen_, text.substr(0, text.find_last_not_of(' ') + 1)) + '\n';
    };
    for (std::size_t i = some.size(); i-- > 0;) {  // the steps, the last column's on top
      if (!is_step(some[i], headers)) continue;
      std::string text = padded(columns_[some[i]].header, ends[i], Align::right);
      for (std::size_t j = i + 1; j < some.size(); ++j) {  // the stems of the steps above
        if (is_step(some[j], headers)) text += spaces(ends[j] - 1 - width_of(text)) + "|";
      }
      add_header(text);
    }
    std::size_t height = 1;
    for (const std::size_t c : some) {
      if (headers == Headers::broken && c > 0) height = std::max(height, broken(columns_[c].header).size());
    }
    for (std::size_t h = 0; h < height; ++h) {
      std::string text = spaces(indent_);
      for (std::size_t i = 0; i < some.size(); ++i) {
        const Column& column = columns_[some[i]];
        std::vector<std::string> lines{column.header};
        if (headers == Headers::broken && some[i] > 0) lines = broken(column.header);
        if (is_step(some[i], headers)) lines = {"|"};
        const std::size_t blank = height - lines.size();
        const Align align = is_step(some[i], headers) ? Align::right : column.align;
        text += (i == 0 ? "" : spaces(kBetween)) + padded(h < blank ? "" : lines[h - blank], widths[i], align);
      }
      add_header(text);
    }
    for (const auto& row : cells_) {
      std::string text = spaces(indent_);
      std::size_t shown = 0;  // up to the last cell that is not blank
      for (std::size_t i = 0; i < some.size(); ++i) {
        const Cell& cell = row[some[i]];
        const std::string cell_text = padded(cell.text, widths[i], columns_[some[i]].align);
        const std::size_t from = cell_text.find_first_not_of(' '), to = cell_text.find_last_not_of(' ') + 1;
        text += i == 0 ? "" : spaces(kBetween);
        if (from == cell_text.npos) {
          text += cell_text;
          continue;
        }
        text += cell_text.substr(0, from);
        const std::string inner = cell_text.substr(from, to - from);
        text += cell.wrong ? red(screen_, inner) : inner;
        shown = text.size();
        text += cell_text.substr(to);
      }
      result += text.substr(0, shown) + '\n';
    }
    return result;
  }

  const std::vector<Column>& columns_;
  const Screen& screen_;
  int indent_;
  std::vector<std::vector<Cell>> cells_;
  std::vector<int> cell_widths_;
};

}  // namespace

std::string TextTable::text(const Screen& screen, int indent) const {
  return Printer(columns_, rows_, screen, indent).all();
}

}  // namespace graze::reports
