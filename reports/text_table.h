// SPDX-License-Identifier: Apache-2.0
// A table for a terminal. Its columns are as wide as their cells. If headers make the table too wide for the screen,
// they are broken into lines or placed above it in steps. If that is not enough, the table is split into blocks.
#pragma once

#include <string>
#include <vector>

#include "reports/screen.h"

namespace graze::reports {

enum class Align { left, right, point };  // point: aligns decimal points

struct Column {
  std::string header;
  Align align = Align::right;
};

struct Cell {
  Cell(std::string what, bool is_wrong = false) : text(std::move(what)), wrong(is_wrong) {}
  std::string text;
  bool wrong;  // shown in red
};

class TextTable {
 public:
  // The first column names the rows and is repeated in each block.
  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

  // Requires: a cell for each column.
  void add(std::vector<Cell> cells) { rows_.push_back(std::move(cells)); }
  std::size_t rows() const { return rows_.size(); }

  // Each line starts with `indent` spaces and ends with a newline, without trailing spaces.
  std::string text(const Screen& screen, int indent = 0) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace graze::reports
