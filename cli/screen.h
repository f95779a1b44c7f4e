// SPDX-License-Identifier: Apache-2.0
// Properties of standard output and standard error as screens.
#pragma once

#include <string>
#include <vector>

#include "reports/screen.h"

namespace graze::cli {

// A terminal has as many columns as it reports or, if it reports none, as COLUMNS says. Its output has colour unless
// NO_COLOR is set or TERM is dumb. Files and pipes have 80 columns and no colour.
reports::Screen output_screen();
reports::Screen error_screen();

// Prints the sentences, each wrapped to the width of standard output.
void print_wrapped(const std::vector<std::string>& sentences);

// The maximum number of lines that a verb prints without --all.
inline constexpr int kMostLines = 40;

// Collects blocks of whole lines up to a limit of lines. Leaves out the first block that does not fit, and all blocks
// after it.
class LimitedText {
 public:
  explicit LimitedText(int most) : left_(most) {}

  // Returns: whether the block was added.
  bool add(const std::string& block);
  bool complete() const { return complete_; }
  const std::string& text() const { return text_; }

 private:
  int left_;
  bool complete_ = true;
  std::string text_;
};

}  // namespace graze::cli
