// SPDX-License-Identifier: Apache-2.0
#include "cuda/twin/generator/cpp_statement.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

namespace graze::cuda::twin {
namespace {

using Names = std::vector<std::string>;

bool one_of(const std::string& word, std::initializer_list<const char*> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

int bytes(const std::string& type) {
  return type.ends_with("64") ? 8 : type.ends_with("32") ? 4 : type.ends_with("16") ? 2 : 1;
}

class Statement {
 public:
  Statement(const Module& module, const Kernel& kernel, const Instruction& instruction)
      : module_(module), kernel_(kernel), instruction_(instruction) {}

  std::string statement() const {
    const Instruction& i = instruction_;
    const std::string& op = i.op[0];
    const std::string& type = i.op.back();
    if (op == "bra") return fmt::format("goto {};", identifier(operand(0)));
    if (op == "ret" || op == "exit") return "return;";
    if (op == "ld" || op == "st") return memory(i);
    if (op == "mov") return move(i);
    if (op == "setp") return compare(i);
    if (op == "cvt") return convert(i);
    if (op == "cvta") return assign(operand(0), "u64", value(operand(1), "u64"));
    if (one_of(op, {"and", "or", "xor", "not"})) return logic(i);
    if (op == "selp") {
      only(i, {});
      return assign(
          operand(0), type,
          fmt::format("{} ? {} : {}", value(operand(3), "pred"), value(operand(1), type), value(operand(2), type)));
    }
    if (op == "testp") {
      if (i.op.size() != 3 || !one_of(i.op[1], {"finite", "infinite", "number", "notanumber", "normal", "subnormal"}))
        fail("unknown instruction");
      return assign(operand(0), "pred", fmt::format("test_{}({})", i.op[1], value(operand(1), type)));
    }
    if (op == "vote" && i.op == Names{"vote", "sync", "ballot", "b32"}) {
      return assign(operand(0), type,
                    fmt::format("u32{{{}}} & {}", value(operand(1), "pred"), value(operand(2), "u32")));
    }
    if (one_of(type, {"f32", "f64"})) return floating(i);
    if (one_of(type, {"u16", "s16", "b16", "u32", "s32", "b32", "u64", "s64", "b64"})) return integer(i);
    fail("unknown instruction");
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw PtxError(fmt::format("{}:{}: {}: {}", module_.path, instruction_.line, why, text(instruction_)));
  }

  const std::string& operand(std::size_t o) const {
    if (o >= instruction_.operands.size()) fail("expected more operands");
    return instruction_.operands[o];
  }

  // Any operand but memory, as a value of the type.
  std::string value(const std::string& name, const std::string& type) const {
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
    static const std::regex kF32("0[fF]([0-9a-fA-F]{8})"), kF64("0[dD]([0-9a-fA-F]{16})"),
        kInteger("-?(0x[0-9a-fA-F]+U?|[0-9]+U?)");
    std::smatch match;
    if (std::regex_match(name, match, kF32))
      return fmt::format("as<{}>(std::bit_cast<f32>(u32{{0x{}u}}))", spelled, match[1].str());
    if (std::regex_match(name, match, kF64))
      return fmt::format("as<{}>(std::bit_cast<f64>(u64{{0x{}u}}))", spelled, match[1].str());
    if (type[0] != 'f' && std::regex_match(name, kInteger))
      return fmt::format("static_cast<{}>({})", spelled,
                         name.find("0x") == std::string::npos ? name + "ll" : name + "ull");
    fail("unknown operand " + name);
  }

  std::string reg(const std::string& name) const {
    if (register_type(kernel_, name).empty()) fail("unknown register " + name);
    return identifier(name);
  }

  // "d = expression;" where the expression has the type; a wider register takes it extended by its sign.
  std::string assign(const std::string& destination, const std::string& type, const std::string& expression) const {
    const std::string own = cpp_type(register_type(kernel_, destination));
    return fmt::format("{} = {};", reg(destination),
                       own == cpp_type(type) ? expression : fmt::format("as<{}>({})", own, expression));
  }

  // "[%rd1+8]" as an address.
  std::string address(const std::string& memory) const {
    static const std::regex kMemory(R"(\[([%\w$]+)(?:\+(-?\d+))?\])");
    std::smatch match;
    if (!std::regex_match(memory, match, kMemory)) fail("unknown address " + memory);
    const std::string offset = match[2].matched ? match[2].str() : "0";
    for (std::size_t p = 0; p < kernel_.parameters.size(); ++p) {
      if (kernel_.parameters[p].name == match[1])
        return fmt::format("reinterpret_cast<u64>(param[{}] + {})", p, offset);
    }
    return fmt::format("{} + static_cast<u64>({}ll)", value(match[1], "u64"), offset);
  }

  Names elements(const std::string& name) const {
    if (name[0] != '{') return {name};
    Names result;
    std::size_t start = 1;
    for (auto comma = name.find_first_of(",}"); comma != std::string::npos; comma = name.find_first_of(",}", start)) {
      result.push_back(name.substr(start, comma - start));
      start = comma + 1;
    }
    return result;
  }

  // The modifiers between the operation and its type must be among these.
  void only(const Instruction& i, std::initializer_list<const char*> known) const {
    for (std::size_t m = 1; m + 1 < i.op.size(); ++m) {
      if (!one_of(i.op[m], known))
        fail(one_of(i.op[m], {"approx", "full", "rz", "rm", "rp"}) ? "cannot be replayed"
                                                                   : "unknown modifier ." + i.op[m]);
    }
  }

  std::string memory(const Instruction& i) const {
    only(i, {"param", "global", "local", "nc", "v2", "v4"});
    const std::string& type = i.op.back();
    const bool loads = i.op[0] == "ld";
    const std::string where = address(operand(loads ? 1 : 0));
    std::string result;
    int offset = 0;
    for (const std::string& name : elements(operand(loads ? 0 : 1))) {
      result += loads ? assign(name, type, fmt::format("load<{}>({} + {})", cpp_type(type), where, offset))
                      : fmt::format("store<{}>({} + {}, {});", cpp_type(type), where, offset, value(name, type));
      offset += bytes(type);
    }
    return offset > bytes(type) ? "{ " + result + " }" : result;
  }

  std::string floating(const Instruction& i) const {
    const std::string& op = i.op[0];
    const std::string& type = i.op.back();
    const bool ftz = i.has("ftz");
    if (ftz && type != "f32") fail("unknown modifier .ftz");
    const auto argument = [&](std::size_t o) {
      return ftz ? fmt::format("flushed({})", value(operand(o), type)) : value(operand(o), type);
    };
    std::string result;
    if (one_of(op, {"add", "sub", "mul", "fma", "div", "sqrt"})) {
      only(i, one_of(op, {"div", "sqrt"}) ? std::initializer_list<const char*>{"rn", "ftz"}
                                          : std::initializer_list<const char*>{"rn", "ftz", "sat"});
      if (!i.has("rn")) fail("the rounding is left open");
      const std::string tail = ftz && one_of(op, {"mul", "div"}) ? "_ftz" : "";
      if (op == "fma") {
        result = fmt::format("fuse{}({}, {}, {}, {})", ftz ? ".flushing" : "", i.site, argument(1), argument(2),
                             argument(3));
      } else {
        result = op == "sqrt" ? fmt::format("sqrt({})", argument(1))
                              : fmt::format("{}{}({}, {})", op, tail, argument(1), argument(2));
      }
      if (ftz && one_of(op, {"add", "sub"})) result = fmt::format("flushed({})", result);
    } else if (one_of(op, {"min", "max"})) {
      only(i, {"ftz", "NaN"});
      result = fmt::format("{}{}({}, {})", op, i.has("NaN") ? "_nan" : "", argument(1), argument(2));
    } else if (one_of(op, {"neg", "abs"})) {
      only(i, {"ftz"});
      result = fmt::format("{}({})", op, argument(1));
    } else if (op == "copysign") {
      only(i, {});
      result = fmt::format("copysign({}, {})", argument(1), argument(2));
    } else {
      fail(one_of(op, {"ex2", "lg2", "sin", "cos", "tanh", "rcp", "rsqrt"}) ? "cannot be replayed"
                                                                            : "unknown instruction");
    }
    if (i.has("sat")) result = fmt::format("saturated({})", result);
    return assign(operand(0), type, result);
  }

  std::string integer(const Instruction& i) const {
    const std::string& op = i.op[0];
    const std::string& type = i.op.back();
    const std::string a = i.operands.size() > 1 ? value(operand(1), type) : "";
    if (one_of(op, {"mul", "mad"})) {
      only(i, {"lo", "hi", "wide"});
      const bool wide = i.has("wide");
      const std::string result_type = wide ? type.substr(0, 1) + std::to_string(16 * bytes(type)) : type;
      if (!wide && !i.has("lo") && !i.has("hi")) fail("unknown modifier");
      if (i.has("hi") && bytes(type) == 8) fail("unknown instruction");
      std::string product = fmt::format("mul_{}<{}>({}, {})",
                                        wide          ? "wide"
                                        : i.has("lo") ? "lo"
                                                      : "hi",
                                        cpp_type(type), a, value(operand(2), type));
      if (op == "mad")
        product = fmt::format("add<{}>({}, {})", cpp_type(result_type), product, value(operand(3), result_type));
      return assign(operand(0), result_type, product);
    }
    only(i, {});
    if (one_of(op, {"add", "sub", "min", "max"}))
      return assign(operand(0), type, fmt::format("{}<{}>({}, {})", op, cpp_type(type), a, value(operand(2), type)));
    if (one_of(op, {"neg", "abs"})) return assign(operand(0), type, fmt::format("{}<{}>({})", op, cpp_type(type), a));
    if (one_of(op, {"shl", "shr"}))
      return assign(operand(0), type, fmt::format("{}<{}>({}, {})", op, cpp_type(type), a, value(operand(2), "u32")));
    fail("unknown instruction");
  }

  std::string logic(const Instruction& i) const {
    only(i, {});
    const std::string& type = i.op.back();
    const std::string a = value(operand(1), type);
    const bool pred = type == "pred";
    if (i.op[0] == "not")
      return assign(operand(0), type, pred ? "!" + a : fmt::format("static_cast<{}>(~{})", cpp_type(type), a));
    const char* symbol = i.op[0] == "and"  ? (pred ? "&&" : "&")
                         : i.op[0] == "or" ? (pred ? "||" : "|")
                         : pred            ? "!="
                                           : "^";
    return assign(operand(0), type,
                  fmt::format("static_cast<{}>({} {} {})", cpp_type(type), a, symbol, value(operand(2), type)));
  }

  // setp.CMP[.BOOL][.ftz].TYPE p[|q], a, b[, [!]c]: p = CMP BOOL c, q = not CMP BOOL c.
  std::string compare(const Instruction& i) const {
    const std::string& type = i.op.back();
    std::string op = i.op.at(1);
    const bool floats = type[0] == 'f';
    if (!one_of(op, {"eq", "ne", "lt", "le", "gt", "ge"}) &&
        !(floats && one_of(op, {"equ", "neu", "ltu", "leu", "gtu", "geu", "num", "nan"})) &&
        !(type[0] == 'u' && one_of(op, {"lo", "ls", "hi", "hs"}))) {
      fail("unknown comparison");
    }
    op = op == "lo" ? "lt" : op == "ls" ? "le" : op == "hi" ? "gt" : op == "hs" ? "ge" : op;
    std::string combine;
    for (std::size_t m = 2; m + 1 < i.op.size(); ++m) {
      if (one_of(i.op[m], {"and", "or", "xor"}))
        combine = i.op[m];
      else if (i.op[m] != "ftz")
        fail("unknown modifier ." + i.op[m]);
    }
    const auto argument = [&](std::size_t o) {
      return i.has("ftz") ? fmt::format("flushed({})", value(operand(o), type)) : value(operand(o), type);
    };
    const std::string result = fmt::format("{}<{}>({}, {})", op, cpp_type(type), argument(1), argument(2));
    const std::string symbol = combine == "and" ? "&&" : combine == "or" ? "||" : "!=";
    const std::string other = combine.empty() ? "" : fmt::format(" {} ({})", symbol, value(operand(3), "pred"));
    const auto bar = operand(0).find('|');
    if (bar == std::string::npos) return fmt::format("{} = {}{};", reg(operand(0)), result, other);
    return fmt::format("{{ const bool is = {0}; const bool p = is{1}, q = !is{1}; {2} = p; {3} = q; }}", result, other,
                       reg(operand(0).substr(0, bar)), reg(operand(0).substr(bar + 1)));
  }

  // cvt[.ROUNDING][.ftz][.sat].TO.FROM
  std::string convert(const Instruction& i) const {
    const std::string& from = i.op.back();
    const std::string to = i.op.at(i.op.size() - 2);
    std::string rounding;
    for (std::size_t m = 1; m + 2 < i.op.size(); ++m) {
      if (one_of(i.op[m], {"rn", "rni", "rzi", "rmi", "rpi"}))
        rounding = i.op[m];
      else if (!one_of(i.op[m], {"ftz", "sat"}))
        fail(one_of(i.op[m], {"rz", "rm", "rp"}) ? "cannot be replayed" : "unknown modifier ." + i.op[m]);
    }
    if (cpp_type(to).empty() || cpp_type(from).empty()) fail("unknown type");
    const bool ftz = i.has("ftz");
    std::string x = value(operand(1), from);
    if (ftz && from == "f32") x = fmt::format("flushed({})", x);
    if (from[0] == 'f' && to[0] == 'f') {
      if (rounding.empty() && bytes(to) < bytes(from)) fail("the rounding is left open");
      if (rounding.size() == 3) x = fmt::format("{}({})", rounding, x);
      x = ftz && bytes(to) < bytes(from) ? fmt::format("narrow_ftz({})", x)
                                         : fmt::format("static_cast<{}>({})", cpp_type(to), x);
      if (i.has("sat")) x = fmt::format("saturated({})", x);
    } else if (i.has("sat")) {
      fail("unknown modifier .sat");
    } else if (from[0] == 'f') {
      if (rounding.size() != 3) fail("the rounding is left open");
      x = fmt::format("to_integer<{}>({}({}))", cpp_type(to), rounding, x);
    } else {
      if (to[0] == 'f' && rounding != "rn") fail("the rounding is left open");
      x = fmt::format("static_cast<{}>({})", cpp_type(to), x);
    }
    return assign(operand(0), to, x);
  }

  // mov, also of a pair of halves: mov.b64 {lo,hi}, a and mov.b64 d, {lo,hi}.
  std::string move(const Instruction& i) const {
    only(i, {});
    const std::string& type = i.op.back();
    if (operand(0)[0] != '{' && operand(1)[0] != '{') return assign(operand(0), type, value(operand(1), type));
    const std::string half = "b" + std::to_string(4 * bytes(type));
    if (cpp_type(half).empty()) fail("unknown instruction");
    const int shift = 4 * bytes(type);
    if (operand(0)[0] == '{') {
      const Names parts = elements(operand(0));
      if (parts.size() != 2) fail("unknown instruction");
      return fmt::format("{{ const {0} whole = {1}; {2} {3} }}", cpp_type(type), value(operand(1), type),
                         assign(parts[0], half, fmt::format("static_cast<{}>(whole)", cpp_type(half))),
                         assign(parts[1], half, fmt::format("static_cast<{}>(whole >> {})", cpp_type(half), shift)));
    }
    const Names parts = elements(operand(1));
    if (parts.size() != 2) fail("unknown instruction");
    return assign(operand(0), type,
                  fmt::format("static_cast<{0}>(static_cast<{0}>({1}) | static_cast<{0}>({2}) << {3})", cpp_type(type),
                              value(parts[0], half), value(parts[1], half), shift));
  }

  const Module& module_;
  const Kernel& kernel_;
  const Instruction& instruction_;
};

}  // namespace

std::string identifier(std::string name) {
  const bool is_register = name[0] == '%';
  std::erase_if(name, [](char c) { return c == '%' || c == '$'; });
  return is_register ? name + "_" : name;
}

std::string cpp_type(const std::string& type) {
  if (type == "pred") return "bool";
  if (type.size() == 3 && type[0] == 'b') return "u" + type.substr(1);
  return one_of(type, {"u16", "u32", "u64", "s16", "s32", "s64", "f32", "f64"}) ? type : std::string();
}

std::string cpp_statement(const Module& module, const Kernel& kernel, const Instruction& instruction) {
  const std::string guard = instruction.guard.empty() ? ""
                                                      : fmt::format("if ({}{}) ", instruction.guard_negated ? "!" : "",
                                                                    identifier(instruction.guard));
  return guard + Statement(module, kernel, instruction).statement();
}

}  // namespace graze::cuda::twin
