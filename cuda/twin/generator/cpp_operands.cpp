// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/generator/cpp_operands.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

#include "core/pattern.h"

namespace graze::cuda::twin {
namespace {

std::string of_bits(const std::string& type, const std::string& own, const std::string& bits) {
  return fmt::format("as<{}>(std::bit_cast<{}>({}{{0x{}u}}))", type, own, own == "f32" ? "u32" : "u64", bits);
}

}  // namespace

std::string identifier(std::string name) {
  const bool is_register = name[0] == '%';
  std::erase_if(name, [](char c) { return c == '%' || c == '$'; });
  return is_register ? name + "_" : name;
}

bool one_of(const std::string& word, std::initializer_list<const char*> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

int bytes(const std::string& type) {
  return type.ends_with("64") ? 8 : type.ends_with("32") ? 4 : type.ends_with("16") ? 2 : 1;
}

std::string cpp_type(const std::string& type) {
  if (type == "pred") return "bool";
  if (one_of(type, {"b8", "b16", "b32", "b64"})) return "u" + type.substr(1);
  return one_of(type, {"u8", "u16", "u32", "u64", "s8", "s16", "s32", "s64", "f32", "f64"}) ? type : std::string();
}

void Operands::fail(const std::string& why) const {
  throw PtxError(fmt::format("{}:{}: {}: {}", module_.path, instruction_.line, why, text(instruction_)));
}

const std::string& Operands::operand(std::size_t o) const {
  if (o >= instruction_.operands.size()) fail("expected more operands");
  return instruction_.operands[o];
}

std::string Operands::value(const std::string& name, const std::string& type) const {
  const std::string spelled = cpp_type(type);
  if (spelled.empty()) fail("unknown type ." + type);
  if (type == "pred") {
    if (name[0] == '!') return "!" + value(name.substr(1), type);
    return name[0] == '%' ? reg(name) : name == "0" ? "false" : "true";
  }
  if (one_of(name, {"%tid.x", "%tid.y", "%tid.z", "%ctaid.x", "%ctaid.y", "%ctaid.z", "%laneid", "%warpid"}))
    return spelled + "{0}";
  if (one_of(name, {"%ntid.x", "%ntid.y", "%ntid.z", "%nctaid.x", "%nctaid.y", "%nctaid.z"})) return spelled + "{1}";
  if (name[0] == '%') {
    const std::string own = cpp_type(register_type(kernel_, name));
    return own == spelled ? reg(name) : fmt::format("as<{}>({})", spelled, reg(name));
  }
  if (!kernel_.local.empty() && name == kernel_.local)
    return fmt::format("reinterpret_cast<u64>({})", identifier(name));
  for (const Table& table : module_.tables) {
    if (table.name == name) return fmt::format("reinterpret_cast<u64>(table_{})", identifier(name));
  }
  static const std::regex kF32("0[fF]([0-9a-fA-F]{8})"), kF64("0[dD]([0-9a-fA-F]{16})"),
      kInteger("-?(0x[0-9a-fA-F]+U?|[0-9]+U?)");
  std::smatch match;
  if (matches(name, match, kF32)) return of_bits(spelled, "f32", match[1]);
  if (matches(name, match, kF64)) return of_bits(spelled, "f64", match[1]);
  if (type[0] != 'f' && matches(name, kInteger))
    return fmt::format("static_cast<{}>({})", spelled,
                       name.find("0x") == std::string::npos ? name + "ll" : name + "ull");
  fail("unknown operand " + name);
}

std::string Operands::reg(const std::string& name) const {
  if (register_type(kernel_, name).empty()) fail("unknown register " + name);
  return identifier(name);
}

std::string Operands::assign(const std::string& destination, const std::string& type,
                             const std::string& expression) const {
  const std::string own = cpp_type(register_type(kernel_, destination));
  return fmt::format("{} = {};", reg(destination),
                     own == cpp_type(type) ? expression : fmt::format("as<{}>({})", own, expression));
}

std::string Operands::address(const std::string& memory) const {
  static const std::regex kMemory(R"(\[([%\w$]+)(?:\+(-?\d+))?\])");
  std::smatch match;
  if (!matches(memory, match, kMemory)) fail("unknown address " + memory);
  const std::string base = match[1], offset = match[2].matched ? match[2].str() : "0";
  for (const auto* list : {&kernel_.parameters, &kernel_.returned}) {
    for (std::size_t p = 0; p < list->size(); ++p) {
      if ((*list)[p].name == base)
        return fmt::format("reinterpret_cast<u64>({}[{}] + {})", list == &kernel_.parameters ? "param" : "returned", p,
                           offset);
    }
  }
  if (instruction_.has("param") && base[0] != '%')  // a parameter of a call
    return fmt::format("reinterpret_cast<u64>({} + {})", identifier(base), offset);
  return fmt::format("{} + static_cast<u64>({}ll)", value(base, "u64"), offset);
}

std::vector<std::string> Operands::elements(const std::string& name) {
  if (name[0] != '{') return {name};
  std::vector<std::string> result;
  std::size_t start = 1;
  for (auto comma = name.find_first_of(",}"); comma != std::string::npos; comma = name.find_first_of(",}", start)) {
    result.push_back(name.substr(start, comma - start));
    start = comma + 1;
  }
  return result;
}

void Operands::only(std::initializer_list<const char*> known) const {
  for (std::size_t m = 1; m + 1 < instruction_.op.size(); ++m) {
    const std::string& modifier = instruction_.op[m];
    if (!one_of(modifier, known))
      fail(one_of(modifier, {"approx", "full", "rz", "rm", "rp"}) ? "cannot be replayed"
                                                                  : "unknown modifier ." + modifier);
  }
}

}  // namespace graze::cuda::twin
