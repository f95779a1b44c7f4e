// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/generator/ptx.h"

#include <algorithm>
#include <istream>
#include <limits>
#include <regex>
#include <set>
#include <stdexcept>

#include "core/pattern.h"

namespace graze::cuda::twin {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1));
}

// Splits the text at separators that are not within brackets or braces.
std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  int depth = 0;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i == text.size() || (text[i] == separator && depth == 0)) {
      parts.push_back(trimmed(text.substr(start, i - start)));
      start = i + 1;
    } else if (text[i] == '[' || text[i] == '{' || text[i] == '(') {
      ++depth;
    } else if (text[i] == ']' || text[i] == '}' || text[i] == ')') {
      --depth;
    }
  }
  return parts;
}

std::string without_spaces(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t'; });
  return text;
}

constexpr std::size_t kMostEntries = 1 << 20;  // entries of a table
constexpr std::size_t kMostShown = 200;        // characters of a statement in an error

class Reader {
 public:
  Reader(std::istream& in, const std::string& path) : in_(in) { module_.path = path; }

  Module read() {
    try {
      read_lines();
    } catch (const std::out_of_range&) {  // std::stoi and similar functions throw it
      fail("expected numbers within range");
    }
    if (kernel_ != nullptr) fail("the file ends within a kernel");
    return std::move(module_);
  }

 private:
  void read_lines() {
    while (next_line()) {
      if (text_.empty() || in_debug_section_) continue;
      if (kernel_ == nullptr) {
        read_outside();
      } else if (!in_body_) {
        read_parameters();
      } else {
        read_statements();
      }
    }
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw PtxError(module_.path + ":" + std::to_string(line_) + ": " + why +
                   (text_.empty() ? "" : ": " + text_.substr(0, kMostShown)));
  }

  // Reads the next line without its comment. Two comments hold information that is nowhere else in the PTX: nvcc's
  // version, and our "// from".
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
      if (matches(remark, match, kVersion)) module_.toolkit = match[1];
      if (matches(remark, match, kFrom)) inlined_at_ = place(match, 1);
      line.resize(comment);
    }
    text_ = trimmed(line);
    return true;
  }

  static Place place(const std::smatch& match, std::size_t at) {
    return {std::stoi(match[at]), std::stoi(match[at + 1]), std::stoi(match[at + 2])};
  }

  // Joins this line and the following lines up to a semicolon.
  void join_lines() {
    const int first = line_;
    std::string whole = text_;
    while (!whole.ends_with(';')) {
      if (!next_line() || text_ == "}") {
        line_ = first;
        text_ = whole;
        fail("expected a semicolon");
      }
      whole += " " + text_;
    }
    text_ = whole;
    line_ = first;
  }

  void read_outside() {
    static const std::regex kVersion(R"(\.version\s+(\S+))"), kTarget(R"(\.target\s+([^\s,]+).*)"),
        kFile(R"re(\.file\s+(\d+)\s+"([^"]*)".*)re"), kEntry(R"((?:\.visible\s+)?\.entry\s+([\w$]+)\s*\(\)?)"),
        kFunction(R"((\.visible\s+|\.weak\s+|\.extern\s+)?\.func\s+(?:\((.*?)\)\s*)?([\w$]+)\s*\(?\)?)"),
        kTable(R"((?:\.visible\s+|\.weak\s+)?\.(?:const|global)\s)");
    std::smatch match;
    const std::string start = text_.substr(0, kMostMatched);  // only a table may be longer
    if (matches(text_, match, kVersion)) {
      module_.version = match[1];
    } else if (matches(text_, match, kTarget)) {
      module_.target = match[1];
    } else if (text_.starts_with(".address_size")) {
      if (!text_.ends_with("64")) fail("expected 64-bit addresses");
    } else if (matches(text_, match, kFile)) {
      module_.files[std::stoi(match[1])] = match[2];
    } else if (text_.starts_with(".section")) {
      in_debug_section_ = true;  // the rest of the file is debug information
    } else if (matches(text_, match, kEntry)) {
      module_.kernels.emplace_back();
      kernel_ = &module_.kernels.back();
      kernel_->name = match[1];
      kernel_->line = line_;
      source_ = {};
    } else if (matches(text_, match, kFunction)) {
      module_.kernels.emplace_back();
      kernel_ = &module_.kernels.back();
      kernel_->name = match[3];
      kernel_->line = line_;
      kernel_->is_function = true;
      kernel_->linkage = match[1].matched ? trimmed(match[1].str()) + " " : "";
      if (match[2].matched) kernel_->returned.push_back(parameter_or_fail(trimmed(match[2].str())));
      source_ = {};
    } else if (std::regex_search(start, kTable, std::regex_constants::match_continuous)) {
      join_lines();
      read_table();
    } else {
      fail("expected a kernel");
    }
  }

  // Reads a table, such as .const .align 4 .b8 NAME[12] = {0, 0, 128, 63, …}; or .global .align 4 .u32 NAME = 7;
  void read_table() {
    static const std::regex kTable(
        R"((?:\.visible |\.weak )?\.(?:const|global)\s+\.align\s+(\d+)\s+\.([busf])(\d+)\s+([\w$]+)(?:\[(\d+)\])?)");
    static const std::regex kHex("0[fFdD]([0-9a-fA-F]+)"), kNumber("-?[0-9]+");
    Table table;
    table.declaration = text_.substr(0, text_.size() - 1);
    std::smatch match;
    const std::size_t equals = std::min(table.declaration.find('='), table.declaration.size());
    const std::string head = trimmed(table.declaration.substr(0, equals));
    if (!matches(head, match, kTable)) fail("expected a table of numbers");
    table.align = std::stoi(match[1]);
    table.name = match[4];
    const std::size_t size = std::stoul(match[3]) / 8, count = match[5].matched ? std::stoul(match[5]) : 1;
    if (size < 1 || size > 8 || count > kMostEntries) fail("expected a table of numbers of 8 to 64 bits");
    std::string values = equals < table.declaration.size() ? trimmed(table.declaration.substr(equals + 1)) : "";
    if (values.starts_with('{')) values = values.substr(1, values.size() - 2);
    for (const std::string& value : values.empty() ? std::vector<std::string>() : split(values, ',')) {
      std::uint64_t bits = 0;
      if (matches(value, match, kHex)) {
        bits = std::stoull(match[1], nullptr, 16);
      } else if (matches(value, kNumber)) {
        bits = value[0] == '-' ? 0 - std::stoull(value.substr(1)) : std::stoull(value);
      } else {
        fail("expected a table of numbers");  // the table may hold addresses of tables or functions
      }
      for (std::size_t b = 0; b < size; ++b) table.bytes.push_back(static_cast<std::uint8_t>(bits >> (8 * b)));
    }
    table.bytes.resize(size * count);
    module_.tables.push_back(std::move(table));
  }

  Parameter parameter_or_fail(const std::string& declaration) const {
    const auto result = parameter(declaration);
    if (!result) fail("expected a parameter");
    return *result;
  }

  void read_parameters() {
    if (text_ == "{") {
      in_body_ = true;
      kernel_->declared_before = declared_.contains(kernel_->name);
    } else if (text_ == ";") {  // only a declaration: the function is defined later or in another file
      declared_.insert(kernel_->name);
      module_.kernels.pop_back();
      kernel_ = nullptr;
    } else if (text_.starts_with(".param")) {
      kernel_->parameters.push_back(
          parameter_or_fail(text_.ends_with(',') ? text_.substr(0, text_.size() - 1) : text_));
    } else if (text_ != "(" && text_ != ")" && !text_.starts_with(".maxntid") && !text_.starts_with(".minnctapersm")) {
      fail("expected a parameter");
    }
  }

  // Reads a line of a body, usually one statement. A line of inline assembly may have several statements and scopes.
  void read_statements() {
    if ((text_.starts_with("call") || text_.starts_with('@') || text_.find(".branchtargets") != text_.npos) &&
        !text_.ends_with(';') && (text_.find("call") != text_.npos || text_.find(".branchtargets") != text_.npos))
      join_lines();
    std::string rest = text_;
    while (!rest.empty() && kernel_ != nullptr) {
      const auto end = rest[0] == '{' || rest[0] == '}' ? 0 : rest.find(';');
      text_ = rest.substr(0, end == rest.npos ? end : end + 1);
      rest = end == rest.npos ? "" : trimmed(rest.substr(end + 1));
      read_inside();
    }
  }

  void add_directive(const std::string& text) {
    Instruction directive;
    directive.directive = text;
    directive.line = line_;
    kernel_->body.push_back(std::move(directive));
  }

  void read_inside() {
    if (text_ == "{") {
      scopes_.emplace_back();
      ++scope_count_;
      add_directive(text_);
    } else if (text_ == "}" && !scopes_.empty()) {
      scopes_.pop_back();
      add_directive(text_);
    } else if (text_ == "}") {
      kernel_ = nullptr;
      in_body_ = false;
    } else if (text_.ends_with(':') && text_.find(' ') == std::string::npos) {
      Instruction label;
      label.label = text_.substr(0, text_.size() - 1);
      label.line = line_;
      kernel_->body.push_back(label);
    } else if (const auto targets = text_.find(": .branchtargets"); targets != text_.npos) {
      const std::string list = text_.substr(targets + 16, text_.size() - targets - 17);
      kernel_->branch_targets[text_.substr(0, targets)] = split(list, ',');
      add_directive(text_);
    } else if (text_[0] == '.') {
      read_directive();
    } else {
      read_instruction();
    }
  }

  void read_directive() {
    static const std::regex kLoc(
        R"(\.loc\s+(\d+)\s+(\d+)\s+(\d+)(?:,\s*function_name\s+[\w$+ ]+,\s*inlined_at\s+(\d+)\s+(\d+)\s+(\d+))?)"),
        kReg(R"(\.reg\s+\.(\w+)\s+([%\w$]+)(?:<(\d+)>)?;)"),
        kLocal(R"(\.local\s+\.align\s+(\d+)\s+\.b8\s+([\w$]+)\[(\d+)\];)");
    std::smatch match;
    if (matches(text_, match, kLoc)) {
      source_ = {place(match, 1), match[4].matched ? place(match, 4) : inlined_at_};
    } else if (matches(text_, match, kReg)) {
      if (!scopes_.empty()) {
        declare_in_scope(match);
      } else {
        kernel_->registers[match[2]] = {match[1], match[3].matched ? std::stoi(match[3]) : 0};
      }
    } else if (matches(text_, match, kLocal)) {
      if (!kernel_->local.empty()) fail("expected at most one local array");
      kernel_->local = match[2];
      kernel_->local_align = std::stoi(match[1]);
      kernel_->local_bytes = std::stoi(match[3]);
    } else if (text_.starts_with(".pragma")) {  // such as "nounroll", without which ptxas unrolls the loop
      add_directive(text_);
    } else if (text_.starts_with(".param") && !scopes_.empty() &&
               parameter(text_.substr(0, text_.size() - 1))) {  // parameter of a call
      add_directive(text_);
    } else {
      fail("expected an instruction");
    }
  }

  // Turns a register of a scope into a register of the kernel, with a unique name.
  void declare_in_scope(const std::smatch& match) {
    if (match[3].matched) fail("expected a single register, found a range of registers");
    if (match[2] == "temp_param_reg") return;  // nvcc declares this register for each call, and never uses it
    std::string name = match[2];
    std::erase(name, '%');
    name = "%scope" + std::to_string(scope_count_) + "_" + name;
    kernel_->registers[name] = {match[1], 0};
    scopes_.back()[match[2]] = name;
  }

  // The operand, with the new names of registers that scopes declare.
  std::string resolved(const std::string& operand) const {
    if (std::all_of(scopes_.begin(), scopes_.end(), [](const auto& scope) { return scope.empty(); })) return operand;
    if (operand.size() > kMostMatched) fail("expected a shorter operand");
    static const std::regex kName(R"([%\w$]+)");
    std::string result;
    auto at = operand.begin();
    for (std::sregex_iterator name(operand.begin(), operand.end(), kName), end; name != end; ++name) {
      result.append(at, operand.begin() + name->position());
      std::string found = name->str();
      for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope) {
        if (const auto row = scope->find(found); row != scope->end()) {
          found = row->second;
          break;
        }
      }
      result += found;
      at = operand.begin() + name->position() + name->length();
    }
    return result.append(at, operand.end());
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
        instruction.operands.push_back(resolved(without_spaces(operand)));
    }
    instruction.guard = resolved(instruction.guard);
    if (instruction.op[0].empty()) fail("expected an instruction");
    kernel_->body.push_back(std::move(instruction));
  }

  std::istream& in_;
  Module module_;
  Kernel* kernel_ = nullptr;
  bool in_body_ = false;
  bool in_debug_section_ = false;
  std::set<std::string> declared_;                          // declared functions
  std::vector<std::map<std::string, std::string>> scopes_;  // registers declared in each scope, with their new names
  int scope_count_ = 0;                                     // the number of scopes in the file so far
  Source source_;
  Place inlined_at_;
  std::string text_;
  int line_ = 0;
};

}  // namespace

bool Instruction::has(std::string_view modifier) const { return std::find(op.begin(), op.end(), modifier) != op.end(); }

std::string text(const Instruction& instruction) {
  if (instruction.is_label()) return instruction.label + ":";
  if (!instruction.is_operation()) return instruction.directive;
  std::string result;
  if (!instruction.guard.empty()) result = (instruction.guard_negated ? "@!" : "@") + instruction.guard + " ";
  for (std::size_t i = 0; i < instruction.op.size(); ++i) result += (i ? "." : "") + instruction.op[i];
  for (std::size_t i = 0; i < instruction.operands.size(); ++i) result += (i ? ", " : " ") + instruction.operands[i];
  return result;
}

std::optional<Parameter> parameter(const std::string& declaration) {
  static const std::regex kParameter(
      R"(\.param\s+(?:\.align \d+ )?\.[a-z](\d+)(?:\s+\.ptr.*)?\s+([\w$]+)(?:\[(\d+)\])?)");
  std::smatch match;
  if (!matches(declaration, match, kParameter)) return std::nullopt;
  const std::int64_t bytes = std::int64_t{std::stoi(match[1])} / 8 * (match[3].matched ? std::stoi(match[3]) : 1);
  if (bytes > std::numeric_limits<int>::max()) return std::nullopt;
  return Parameter{declaration, match[2], static_cast<int>(bytes)};
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
