// SPDX-License-Identifier: Apache-2.0
#include "subjects/toolchains/assembly.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <sstream>

#include "core/fnv1a.h"
#include "core/plain_file.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;

// An instruction: its name, and its operands from left to right.
struct Instruction {
  std::string_view name;
  std::vector<std::string> operands;
};

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") + 1 - first);
}

// The instruction in a line of assembly, without comments; nothing if there is none. Commas outside brackets separate
// operands.
std::optional<Instruction> instruction_of(std::string_view line) {
  if (line.empty() || (line[0] != '\t' && line[0] != ' ')) return std::nullopt;
  line = trimmed(line);
  for (const std::string_view comment : {"//", "##", "# ", ";"}) line = trimmed(line.substr(0, line.find(comment)));
  if (line.empty() || line[0] == '.' || line.ends_with(':')) return std::nullopt;
  const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
  Instruction found{line.substr(0, end), {}};
  std::string operand;
  int depth = 0;
  for (const char c : line.substr(end)) {
    depth += c == '(' || c == '[' || c == '{';
    depth -= c == ')' || c == ']' || c == '}';
    if (c == ',' && depth == 0) {
      found.operands.emplace_back(trimmed(operand));
      operand.clear();
    } else {
      operand.push_back(c);
    }
  }
  if (const std::string_view last = trimmed(operand); !last.empty()) found.operands.emplace_back(last);
  return found;
}

bool take(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

// A fused operation by the signs of its product and its addend: a*b + c, a*b - c, -a*b + c, -a*b - c.
enum class Fused { madd, msub, nmadd, nmsub };
constexpr std::string_view kFused[] = {"madd", "msub", "nmadd", "nmsub"};

struct FusedOperation {
  Fused fused;
  std::string numbers;  // "f32", "f64", "f32 vector"
  int times = 1;        // the number of operations in one instruction
};

std::string numbers(bool in_double, bool vector) {
  return std::string(in_double ? "f64" : "f32") + (vector ? " vector" : "");
}

// The mnemonic of an x86-64 instruction, such as vfmadd231ss.
std::optional<FusedOperation> on_x86(std::string_view name) {
  if (!take(name, "vf")) return std::nullopt;
  const bool negative = take(name, "n");
  const bool adds = take(name, "madd");
  if (!adds && !take(name, "msub")) return std::nullopt;
  if (name.size() != 5) return std::nullopt;
  const Fused fused = negative ? adds ? Fused::nmadd : Fused::nmsub : adds ? Fused::madd : Fused::msub;
  return FusedOperation{fused, numbers(name[4] == 'd', name[3] == 'p')};
}

// The operation of an ARM64 instruction, such as fmadd s0, s1, s2, s3 or fmla v0.4s, v1.4s, v2.4s. ARM64's fmsub
// negates the product, and its fnmadd both terms.
std::optional<FusedOperation> on_arm64(const Instruction& i) {
  if (i.operands.empty()) return std::nullopt;
  const std::string& to = i.operands[0];
  const bool is_vector = to[0] == 'v';
  if (is_vector || to[0] == 's' || to[0] == 'd') {
    const std::string of = numbers(is_vector ? to.find("d") != to.npos : to[0] == 'd', is_vector);
    if (i.name == "fmla") return FusedOperation{Fused::madd, of};
    if (i.name == "fmls") return FusedOperation{Fused::nmadd, of};
    if (is_vector || i.operands.size() != 4) return std::nullopt;
    if (i.name == "fmadd") return FusedOperation{Fused::madd, of};
    if (i.name == "fmsub") return FusedOperation{Fused::nmadd, of};
    if (i.name == "fnmadd") return FusedOperation{Fused::nmsub, of};
    if (i.name == "fnmsub") return FusedOperation{Fused::msub, of};
  }
  return std::nullopt;
}

// The operation of a RISC-V instruction, such as fmadd.s fa0,fa1,fa2,fa3. RISC-V's fnmadd negates both terms, and its
// fnmsub the product.
std::optional<FusedOperation> on_riscv(std::string_view name) {
  const bool in_double = name.ends_with(".d");
  if (!in_double && !name.ends_with(".s")) return std::nullopt;
  name.remove_suffix(2);
  const std::string of = numbers(in_double, false);
  if (name == "fmadd") return FusedOperation{Fused::madd, of};
  if (name == "fmsub") return FusedOperation{Fused::msub, of};
  if (name == "fnmadd") return FusedOperation{Fused::nmsub, of};
  if (name == "fnmsub") return FusedOperation{Fused::nmadd, of};
  return std::nullopt;
}

// The operation of a Power instruction, such as fmadds 0,1,2,3 or xsmaddadp 0,1,2. Power's nmadd and nmsub negate the
// rounded results of madd and msub.
std::optional<FusedOperation> on_power(const Instruction& i) {
  std::string_view name = i.name;
  const bool is_scalar = take(name, "xs") || take(name, "f"), is_vector = !is_scalar && take(name, "xv");
  if ((!is_scalar && !is_vector) || i.operands.empty() || !std::isdigit(static_cast<unsigned char>(i.operands[0][0])))
    return std::nullopt;
  const bool negative = take(name, "n");
  const bool adds = take(name, "madd");
  if (!adds && !take(name, "msub")) return std::nullopt;
  const bool in_double = name.empty() || name.ends_with("dp");
  if (!name.empty() && name != "s" && name != "adp" && name != "mdp" && name != "asp" && name != "msp")
    return std::nullopt;
  const Fused fused = negative ? adds ? Fused::nmsub : Fused::nmadd : adds ? Fused::madd : Fused::msub;
  return FusedOperation{fused, numbers(in_double, is_vector)};
}

// The operation of an instruction for AMD's GPUs, such as v_fma_f32, v_fmac_f32, v_mac_f32 or v_fmaak_f32. A
// v_pk_fma_f32 has two operations. Ignores the signs, which are in the operands.
std::optional<FusedOperation> on_amd(std::string_view name) {
  if (!take(name, "v_")) return std::nullopt;
  const int times = take(name, "pk_") ? 2 : 1;
  const std::string_view kind = name.substr(0, name.find('_'));
  constexpr std::string_view kKinds[] = {"fma", "fmac", "fmaak", "fmamk", "mac", "mad", "madak", "madmk"};
  if (std::find(std::begin(kKinds), std::end(kKinds), kind) == std::end(kKinds)) return std::nullopt;
  name.remove_prefix(std::min(kind.size() + 1, name.size()));
  if (!name.starts_with("f32") && !name.starts_with("f64")) return std::nullopt;
  return FusedOperation{Fused::madd, numbers(name.starts_with("f64"), false), times};
}

// A division on AMD's GPUs takes five fused operations that are not contractions; the last of them is v_div_fmas_f32.
constexpr int kFusedInDivision = 5;
std::optional<std::string> division_on_amd(std::string_view name) {
  if (!take(name, "v_div_fmas_")) return std::nullopt;
  return numbers(name.starts_with("f64"), false);
}

std::optional<FusedOperation> fused_operation(const Instruction& i) {
  if (auto found = on_x86(i.name)) return found;
  if (auto found = on_arm64(i)) return found;
  if (auto found = on_riscv(i.name)) return found;
  if (auto found = on_power(i)) return found;
  return on_amd(i.name);
}

int number_of(std::string_view& text) {
  text = trimmed(text);
  int number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return error == std::errc() ? number : -1;
}

// The next text in quotes, with a backslash before each quote and backslash; nothing if there is none.
std::optional<std::string> quoted(std::string_view& text) {
  text = trimmed(text);
  if (!take(text, "\"")) return std::nullopt;
  std::string found;
  for (; !text.empty() && text[0] != '"'; text.remove_prefix(1)) {
    if (text[0] == '\\' && text.size() > 1) text.remove_prefix(1);
    found.push_back(text[0]);
  }
  take(text, "\"");
  return found;
}

// Calls visit(text, file, line, instruction) for each line of the assembly. `file` and `line` give its place in the
// source.
template <class Visit>
void for_each_line(std::string_view assembly, const fs::path& folder, Visit visit) {
  std::map<int, std::string> files;
  std::string file;
  int line = 0;
  for (std::size_t begin = 0; begin < assembly.size();) {
    const std::size_t end = std::min(assembly.find('\n', begin), assembly.size());
    const std::string_view text = assembly.substr(begin, end - begin);
    begin = end + 1;
    std::string_view words = trimmed(text);
    if (take(words, ".file\t") || take(words, ".file ")) {
      if (const int number = number_of(words); number >= 0) {
        fs::path path = quoted(words).value_or("");
        if (const std::optional<std::string> within = quoted(words)) path /= *within;
        const fs::path relative = path.lexically_normal().lexically_relative(folder);
        files[number] = relative.empty() || *relative.begin() == ".." ? path.string() : relative.string();
      }
    } else if (take(words, ".loc\t") || take(words, ".loc ")) {
      file = files[number_of(words)];
      line = number_of(words);
    }
    visit(text, file, line, instruction_of(text));
  }
}

// The code for a fused x86-64 operation with its product rounded, in AT&T syntax: vfmadd213ss op3, op2, op1. The code
// uses two other registers, whose values it saves below the red zone.
std::optional<std::string> rounded_on_x86(const Instruction& i, Fused fused) {
  if (i.operands.size() != 3) return std::nullopt;
  const std::string &op3 = i.operands[0], &op2 = i.operands[1], &op1 = i.operands[2];
  const std::string_view form = i.name.substr(i.name.size() - 5, 3), type = i.name.substr(i.name.size() - 2);
  if (op1.size() < 5 || (!op1.starts_with("%xmm") && !op1.starts_with("%ymm"))) return std::nullopt;
  std::vector<std::string> free;
  for (int r = 15; r >= 0 && free.size() < 2; --r) {
    const std::string number = "mm" + std::to_string(r);
    if (std::none_of(i.operands.begin(), i.operands.end(), [&](const std::string& o) { return o.ends_with(number); }))
      free.push_back(std::to_string(r));
  }
  const std::string kind = op1.substr(0, 4), product = kind + free[0], sign = kind + free[1];
  const std::string &left = form == "132" ? op1 : op2, &right = form == "213" ? op1 : op3,
                    &addend = form == "132"   ? op2
                              : form == "213" ? op3
                                              : op1;
  std::string text = fmt::format("\tvmovups\t%ymm{}, -192(%rsp)\n\tvmovups\t%ymm{}, -224(%rsp)\n", free[0], free[1]);
  text += fmt::format("\tvmul{}\t{}, {}, {}\n", type, right, left, product);
  if (fused == Fused::nmsub)
    text += fmt::format("\tvpcmpeqd\t{0}, {0}, {0}\n\tvpsll{1}\t${2}, {0}, {0}\n\tvxorps\t{0}, {3}, {3}\n", sign,
                        type.ends_with('d') ? 'q' : 'd', type.ends_with('d') ? 63 : 31, product);
  if (fused != Fused::nmadd) {
    text += fmt::format("\tv{}{}\t{}, {}, {}\n", fused == Fused::madd ? "add" : "sub", type, addend, product, op1);
  } else if (addend.starts_with('%')) {
    text += fmt::format("\tvsub{}\t{}, {}, {}\n", type, product, addend, op1);
  } else {
    text += fmt::format("\tvmov{}\t{}, {}\n\tvsub{}\t{}, {}, {}\n",
                        type[0] == 's' ? type
                        : type == "ps" ? "ups"
                                       : "upd",
                        addend, op1, type, product, op1, op1);
  }
  return text + fmt::format("\tvmovups\t-192(%rsp), %ymm{}\n\tvmovups\t-224(%rsp), %ymm{}\n", free[0], free[1]);
}

// The number of an ARM64 register, such as 31 for v31.4s, s31 and v31.s[0].
int register_of(std::string_view operand) {
  operand.remove_prefix(1);
  return number_of(operand);
}

// The code for a fused ARM64 operation with its product rounded. The code uses another register, whose value it saves
// on the stack.
std::optional<std::string> rounded_on_arm64(const Instruction& i, Fused fused) {
  const std::string& to = i.operands[0];
  const bool accumulates = i.operands.size() == 3;
  const std::string &left = i.operands[1], &right = i.operands[2], &addend = accumulates ? to : i.operands[3];
  int free = 31;
  while (
      std::any_of(i.operands.begin(), i.operands.end(), [&](const std::string& o) { return register_of(o) == free; }))
    --free;
  const std::string product = fmt::format("{}{}{}", to[0], free, to.substr(std::min(to.find('.'), to.size())));
  std::string text = fmt::format("\tstr\tq{0}, [sp, #-16]!\n\tfmul\t{1}, {2}, {3}\n", free, product, left, right);
  if (fused == Fused::nmsub) text += fmt::format("\tfneg\t{0}, {0}\n", product);
  if (fused == Fused::msub || fused == Fused::nmsub) {
    text += fmt::format("\tfsub\t{}, {}, {}\n", to, product, addend);
  } else {
    text += fmt::format("\t{}\t{}, {}, {}\n", fused == Fused::madd ? "fadd" : "fsub", to, addend, product);
  }
  return text + fmt::format("\tldr\tq{}, [sp], #16\n", free);
}

}  // namespace

std::vector<FusedLine> fused_lines(std::string_view assembly, const fs::path& folder, std::string_view numbers) {
  std::map<std::pair<std::string, int>, std::map<std::string, int>> by_line;
  for_each_line(assembly, folder, [&](std::string_view, const std::string& file, int line, const auto& instruction) {
    if (!instruction) return;
    const auto count = [&](Fused fused, const std::string& of, int times) {
      if (of.starts_with(numbers))
        by_line[{file, line}][fmt::format("{} {}", kFused[static_cast<int>(fused)], of)] += times;
    };
    if (const auto found = fused_operation(*instruction)) count(found->fused, found->numbers, found->times);
    if (const auto divided = division_on_amd(instruction->name)) count(Fused::madd, *divided, -kFusedInDivision);
  });
  for (auto& [place, operations] : by_line) std::erase_if(operations, [](const auto& row) { return row.second == 0; });
  std::erase_if(by_line, [](const auto& row) { return row.second.empty(); });
  std::vector<FusedLine> result;
  for (const auto& [place, operations] : by_line) {
    std::vector<std::string> words;
    int all = 0;
    for (const auto& [operation, count] : operations) {
      words.push_back(count == 1 ? operation : fmt::format("{} x{}", operation, count));
      all += count;
    }
    result.push_back({place.first, place.second, fmt::format("{}", fmt::join(words, ", ")), all, ""});
  }
  return result;
}

void read_code(std::vector<FusedLine>& plan, const fs::path& folder) {
  std::map<std::string, std::vector<std::string>> files;
  for (FusedLine& fused : plan) {
    std::vector<std::string>& lines = files[fused.file];
    if (lines.empty()) {
      std::string why;
      std::istringstream text(plain_file(folder / fused.file, why).value_or(""));
      lines.emplace_back();  // so that lines count from 1
      for (std::string line; std::getline(text, line);) lines.emplace_back(trimmed(line));
    }
    if (fused.line > 0 && static_cast<std::size_t>(fused.line) < lines.size())
      fused.code = lines[static_cast<std::size_t>(fused.line)];
  }
}

std::uint64_t plan_hash(const std::vector<FusedLine>& plan) {
  std::uint64_t hash = fnv1a("");
  for (const FusedLine& line : plan) {
    const fs::path file(line.file);
    hash = fnv1a(fmt::format("{}: {}: {}\n", (file.is_absolute() ? file.filename() : file).string(),
                             line.code.empty() ? std::to_string(line.line) : line.code, line.operations),
                 hash);
  }
  return hash;
}

int operations_of(const std::vector<FusedLine>& plan) {
  int all = 0;
  for (const FusedLine& line : plan) all += line.count;
  return all;
}

std::string why_not_read(std::string_view target) {
  for (const std::string_view known :
       {"x86_64", "i386", "i486", "i586", "i686", "aarch64", "arm64", "riscv", "powerpc", "ppc", "amdgcn"}) {
    if (target.starts_with(known)) return "";
  }
  if (target.starts_with("wasm")) return "WebAssembly has no fused operations";
  return fmt::format("graze does not read assembly for {}", target.empty() ? "an unnamed processor" : target);
}

std::string plan_in_words(const std::vector<FusedLine>& plan) {
  const auto counted = [](std::size_t count, std::string_view what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
  };
  if (plan.empty()) return "no fused operation";
  return fmt::format("{} on {}, plan {:016x}",
                     counted(static_cast<std::size_t>(operations_of(plan)), "fused operation"),
                     counted(plan.size(), "line"), plan_hash(plan));
}

nlohmann::ordered_json plan_json(const std::vector<FusedLine>& plan) {
  nlohmann::ordered_json lines = nlohmann::ordered_json::array();
  for (const FusedLine& line : plan) lines.push_back({{"place", line.place()}, {"operations", line.operations}});
  return {{"plan", fmt::format("{:016x}", plan_hash(plan))},
          {"operations", operations_of(plan)},
          {"lines", std::move(lines)}};
}

std::optional<std::string> with_rounded_products(std::string_view assembly, const fs::path& folder,
                                                 const FusedLine& wanted) {
  std::string result;
  bool all = true;
  for_each_line(assembly, folder,
                [&](std::string_view text, const std::string& file, int line, const auto& instruction) {
                  std::optional<FusedOperation> found;
                  if (instruction && file == wanted.file && line == wanted.line) found = fused_operation(*instruction);
                  std::optional<std::string> rounded;
                  if (found && on_x86(instruction->name)) rounded = rounded_on_x86(*instruction, found->fused);
                  if (found && on_arm64(*instruction)) rounded = rounded_on_arm64(*instruction, found->fused);
                  all = all && found.has_value() == rounded.has_value();
                  result += rounded ? *rounded : std::string(text) + '\n';
                });
  return all ? std::optional(result) : std::nullopt;
}

}  // namespace graze::subjects
