// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/generator/ptx.h"

#include <algorithm>
#include <istream>
#include <regex>

namespace graze::cuda::twin {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1));
}

// Splits at the separator, but not within brackets and braces.
std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  int depth = 0;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i == text.size() || (text[i] == separator && depth == 0)) {
      parts.push_back(trimmed(text.substr(start, i - start)));
      start = i + 1;
    } else if (text[i] == '[' || text[i] == '{') {
      ++depth;
    } else if (text[i] == ']' || text[i] == '}') {
      --depth;
    }
  }
  return parts;
}

std::string without_spaces(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  return text;
}

class Reader {
 public:
  Reader(std::istream& in, const std::string& path) : in_(in) { module_.path = path; }

  Module read() {
    while (next_line()) {
      if (text_.empty() || in_debug_section_) continue;
      if (kernel_ == nullptr) {
        read_outside();
      } else if (!in_body_) {
        read_parameters();
      } else {
        read_inside();
      }
    }
    if (kernel_ != nullptr) fail("the file ends within a kernel");
    return std::move(module_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw PtxError(module_.path + ":" + std::to_string(line_) + ": " + why + (text_.empty() ? "" : ": " + text_));
  }

  // The next line without its comment, but for two that say more than PTX can: nvcc's version, and our "// from".
  bool next_line() {
    static const std::regex kVersion(R"(// Cuda compilation tools, release [0-9.]+, V([0-9.]+))"),
        kFrom(R"(// from (\d+) (\d+) (\d+))");
    std::string line;
    if (!std::getline(in_, line)) return false;
    ++line_;
    inlined_at_ = {};
    if (const auto comment = line.find("//"); comment != std::string::npos) {
      std::smatch match;
      const std::string remark = line.substr(comment);
      if (std::regex_match(remark, match, kVersion)) module_.toolkit = match[1];
      if (std::regex_match(remark, match, kFrom)) inlined_at_ = place(match, 1);
      line.resize(comment);
    }
    text_ = trimmed(line);
    return true;
  }

  static Place place(const std::smatch& match, std::size_t at) {
    return {std::stoi(match[at]), std::stoi(match[at + 1]), std::stoi(match[at + 2])};
  }

  void read_outside() {
    static const std::regex kVersion(R"(\.version\s+(\S+))"), kTarget(R"(\.target\s+([^\s,]+).*)"),
        kFile(R"re(\.file\s+(\d+)\s+"([^"]*)".*)re"), kEntry(R"((?:\.visible\s+)?\.entry\s+([\w$]+)\s*\()");
    std::smatch match;
    if (std::regex_match(text_, match, kVersion)) {
      module_.version = match[1];
    } else if (std::regex_match(text_, match, kTarget)) {
      module_.target = match[1];
    } else if (text_.starts_with(".address_size")) {
      if (!text_.ends_with("64")) fail("expected 64-bit addresses");
    } else if (std::regex_match(text_, match, kFile)) {
      module_.files[std::stoi(match[1])] = match[2];
    } else if (text_.starts_with(".section")) {
      in_debug_section_ = true;  // to the end of the file
    } else if (std::regex_match(text_, match, kEntry)) {
      module_.kernels.emplace_back();
      kernel_ = &module_.kernels.back();
      kernel_->name = match[1];
      kernel_->line = line_;
      source_ = {};
    } else {
      fail("expected a kernel");
    }
  }

  void read_parameters() {
    static const std::regex kParameter(R"(\.param\s+(?:\.align \d+ )?\.\w+(?:\s+\.ptr.*)?\s+([\w$]+)(?:\[\d+\])?)");
    if (text_ == "{") {
      in_body_ = true;
    } else if (text_.starts_with(".param")) {
      std::smatch match;
      const std::string declaration = text_.ends_with(',') ? text_.substr(0, text_.size() - 1) : text_;
      if (!std::regex_match(declaration, match, kParameter)) fail("expected a parameter");
      kernel_->parameters.push_back({declaration, match[1]});
    } else if (text_ != ")" && !text_.starts_with(".maxntid") && !text_.starts_with(".minnctapersm")) {
      fail("expected a parameter");
    }
  }

  void read_inside() {
    if (text_ == "}") {
      kernel_ = nullptr;
      in_body_ = false;
    } else if (text_.ends_with(':') && text_.find(' ') == std::string::npos) {
      Instruction label;
      label.label = text_.substr(0, text_.size() - 1);
      label.line = line_;
      kernel_->body.push_back(label);
    } else if (text_[0] == '.') {
      read_directive();
    } else {
      read_instruction();
    }
  }

  void read_directive() {
    static const std::regex kLoc(
        R"(\.loc\s+(\d+)\s+(\d+)\s+(\d+)(?:,\s*function_name\s+[\w$+ ]+,\s*inlined_at\s+(\d+)\s+(\d+)\s+(\d+))?)"),
        kReg(R"(\.reg\s+\.(\w+)\s+(%\w+)(?:<(\d+)>)?;)"),
        kLocal(R"(\.local\s+\.align\s+(\d+)\s+\.b8\s+([\w$]+)\[(\d+)\];)");
    std::smatch match;
    if (std::regex_match(text_, match, kLoc)) {
      source_ = {place(match, 1), match[4].matched ? place(match, 4) : inlined_at_};
    } else if (std::regex_match(text_, match, kReg)) {
      kernel_->registers[match[2]] = {match[1], match[3].matched ? std::stoi(match[3]) : 0};
    } else if (std::regex_match(text_, match, kLocal)) {
      if (!kernel_->local.empty()) fail("expected one local array at most");
      kernel_->local = match[2];
      kernel_->local_align = std::stoi(match[1]);
      kernel_->local_bytes = std::stoi(match[3]);
    } else if (!text_.starts_with(".pragma")) {  // such as "nounroll": about speed
      fail("expected an instruction");
    }
  }

  void read_instruction() {
    if (!text_.ends_with(';')) fail("expected an instruction that ends on its line");
    Instruction instruction;
    instruction.line = line_;
    instruction.source = source_;
    std::string rest = text_.substr(0, text_.size() - 1);
    if (rest.starts_with('@')) {
      const auto end = rest.find_first_of(" \t");
      instruction.guard_negated = rest[1] == '!';
      instruction.guard = rest.substr(instruction.guard_negated ? 2 : 1, end - (instruction.guard_negated ? 2 : 1));
      rest = end == std::string::npos ? "" : trimmed(rest.substr(end));
    }
    const auto end = rest.find_first_of(" \t");
    instruction.op = split(rest.substr(0, end), '.');
    if (end != std::string::npos) {
      for (const std::string& operand : split(rest.substr(end), ','))
        instruction.operands.push_back(without_spaces(operand));
    }
    if (instruction.op[0].empty()) fail("expected an instruction");
    kernel_->body.push_back(std::move(instruction));
  }

  std::istream& in_;
  Module module_;
  Kernel* kernel_ = nullptr;
  bool in_body_ = false;
  bool in_debug_section_ = false;
  Source source_;
  Place inlined_at_;
  std::string text_;
  int line_ = 0;
};

}  // namespace

bool Instruction::has(std::string_view modifier) const { return std::find(op.begin(), op.end(), modifier) != op.end(); }

std::string text(const Instruction& instruction) {
  if (instruction.is_label()) return instruction.label + ":";
  std::string result;
  if (!instruction.guard.empty()) result = (instruction.guard_negated ? "@!" : "@") + instruction.guard + " ";
  for (std::size_t i = 0; i < instruction.op.size(); ++i) result += (i ? "." : "") + instruction.op[i];
  for (std::size_t i = 0; i < instruction.operands.size(); ++i) result += (i ? ", " : " ") + instruction.operands[i];
  return result;
}

std::string register_type(const Kernel& kernel, std::string_view name) {
  if (const auto single = kernel.registers.find(std::string(name));
      single != kernel.registers.end() && single->second.second == 0)
    return single->second.first;
  const auto digits = name.find_last_not_of("0123456789") + 1;
  const auto row = kernel.registers.find(std::string(name.substr(0, digits)));
  if (row == kernel.registers.end() || digits == name.size()) return {};
  return std::stoi(std::string(name.substr(digits))) < row->second.second ? row->second.first : std::string();
}

Module read_ptx(std::istream& in, const std::string& path) { return Reader(in, path).read(); }

}  // namespace graze::cuda::twin
