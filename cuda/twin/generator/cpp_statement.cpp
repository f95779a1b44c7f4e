// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cuda/twin/generator/cpp_operands.h"

namespace graze::cuda::twin {
namespace {

using Names = std::vector<std::string>;

std::string memory(const Operands& o) {
  const Instruction& i = o.instruction();
  o.only({"param", "global", "local", "const", "nc", "volatile", "v2", "v4"});
  const std::string& type = o.type();
  if (cpp_type(type).empty()) o.fail("unknown type ." + type);
  const bool loads = i.op[0] == "ld";
  std::string where = o.address(o.operand(loads ? 1 : 0)), result;
  const Names elements = Operands::elements(o.operand(loads ? 0 : 1));
  if (elements.size() > 1) {  // the first load may overwrite the register of the address
    result = fmt::format("const u64 at = {}; ", where);
    where = "at";
  }
  int offset = 0;
  for (const std::string& name : elements) {
    result += loads ? o.assign(name, type, fmt::format("load<{}>({} + {})", cpp_type(type), where, offset))
                    : fmt::format("store<{}>({} + {}, {});", cpp_type(type), where, offset, o.value(name, type));
    offset += bytes(type);
  }
  return elements.size() > 1 ? "{ " + result + " }" : result;
}

std::string logic(const Operands& o) {
  o.only({});
  const std::string& type = o.type();
  const std::string a = o.value(1, type), &op = o.instruction().op[0];
  const bool pred = type == "pred";
  if (op == "not") return o.assign(type, pred ? "!" + a : fmt::format("static_cast<{}>(~{})", cpp_type(type), a));
  const char* symbol = op == "and" ? (pred ? "&&" : "&") : op == "or" ? (pred ? "||" : "|") : pred ? "!=" : "^";
  return o.assign(type, fmt::format("static_cast<{}>({} {} {})", cpp_type(type), a, symbol, o.value(2, type)));
}

// setp.CMP[.BOOL][.ftz].TYPE p[|q], a, b[, [!]c]: p = CMP BOOL c, q = not CMP BOOL c.
std::string compare(const Operands& o) {
  const Instruction& i = o.instruction();
  const std::string& type = o.type();
  std::string op = i.op.at(1);
  const bool floats = type[0] == 'f';
  if (!one_of(op, {"eq", "ne", "lt", "le", "gt", "ge"}) &&
      !(floats && one_of(op, {"equ", "neu", "ltu", "leu", "gtu", "geu", "num", "nan"})) &&
      !(type[0] == 'u' && one_of(op, {"lo", "ls", "hi", "hs"}))) {
    o.fail("unknown comparison");
  }
  op = op == "lo" ? "lt" : op == "ls" ? "le" : op == "hi" ? "gt" : op == "hs" ? "ge" : op;
  std::string combine;
  for (std::size_t m = 2; m + 1 < i.op.size(); ++m) {
    if (one_of(i.op[m], {"and", "or", "xor"}))
      combine = i.op[m];
    else if (i.op[m] != "ftz")
      o.fail("unknown modifier ." + i.op[m]);
  }
  const auto argument = [&](std::size_t at) {
    return i.has("ftz") ? fmt::format("flushed({})", o.value(at, type)) : o.value(at, type);
  };
  std::string result = fmt::format("{}<{}>({}, {})", op, cpp_type(type), argument(1), argument(2));
  if (floats) result = fmt::format("fuse.compared({}, {}, {}, {})", i.line, argument(1), argument(2), result);
  const std::string symbol = combine == "and" ? "&&" : combine == "or" ? "||" : "!=";
  const std::string other = combine.empty() ? "" : fmt::format(" {} ({})", symbol, o.value(3, "pred"));
  const auto bar = o.operand(0).find('|');
  if (bar == std::string::npos) return fmt::format("{} = {}{};", o.reg(o.operand(0)), result, other);
  return fmt::format("{{ const bool is = {0}; const bool p = is{1}, q = !is{1}; {2} = p; {3} = q; }}", result, other,
                     o.reg(o.operand(0).substr(0, bar)), o.reg(o.operand(0).substr(bar + 1)));
}

// cvt[.ROUNDING][.ftz][.sat].TO.FROM
std::string convert(const Operands& o) {
  const Instruction& i = o.instruction();
  const std::string &from = o.type(), to = i.op.at(i.op.size() - 2);
  std::string rounding;
  for (std::size_t m = 1; m + 2 < i.op.size(); ++m) {
    if (one_of(i.op[m], {"rn", "rz", "rm", "rp", "rni", "rzi", "rmi", "rpi"}))
      rounding = i.op[m];
    else if (!one_of(i.op[m], {"ftz", "sat"}))
      o.fail("unknown modifier ." + i.op[m]);
  }
  if (cpp_type(to).empty() || cpp_type(from).empty()) o.fail("unknown type");
  const bool ftz = i.has("ftz"), directed = one_of(rounding, {"rz", "rm", "rp"});
  std::string x = o.value(1, from);
  if (ftz && from == "f32") x = fmt::format("flushed({})", x);
  if (from[0] == 'f' && to[0] == 'f') {
    if (rounding.empty() && bytes(to) < bytes(from)) o.fail("the rounding is left open");
    if (rounding.size() == 3) x = fmt::format("{}({})", rounding, x);
    if (directed) {
      if (bytes(to) >= bytes(from)) o.fail("unknown instruction");
      x = fmt::format("rounded_narrow<Rounding::{}, {}>({})", rounding, ftz ? "true" : "false", x);
    } else {
      x = ftz && bytes(to) < bytes(from) ? fmt::format("narrow_ftz({})", x)
                                         : fmt::format("static_cast<{}>({})", cpp_type(to), x);
    }
    if (i.has("sat")) x = fmt::format("saturated({})", x);
  } else if (from[0] == 'f') {
    if (rounding.size() != 3) o.fail("the rounding is left open");
    if (bytes(to) == 1) o.fail("unknown instruction");
    x = fmt::format("to_integer<{}>({}({}))", cpp_type(to), rounding, x);  // .sat changes nothing: to_integer saturates
  } else if (to[0] == 'f') {
    if (i.has("sat")) o.fail("unknown modifier .sat");
    if (rounding != "rn" && !directed) o.fail("the rounding is left open");
    x = directed ? fmt::format("rounded_integer<Rounding::{}, {}>({})", rounding, cpp_type(to), x)
                 : fmt::format("static_cast<{}>({})", cpp_type(to), x);
  } else {
    x = i.has("sat") ? fmt::format("clamped<{}>({})", cpp_type(to), x)
                     : fmt::format("static_cast<{}>({})", cpp_type(to), x);
  }
  return o.assign(to, x);
}

// mov, including moves between a register and its two halves: mov.b64 {lo,hi}, a and mov.b64 d, {lo,hi}.
std::string move(const Operands& o) {
  o.only({});
  const std::string& type = o.type();
  if (o.operand(0)[0] != '{' && o.operand(1)[0] != '{') return o.assign(type, o.value(1, type));
  const std::string half = "b" + std::to_string(4 * bytes(type));
  if (cpp_type(half).empty()) o.fail("unknown instruction");
  const int shift = 4 * bytes(type);
  const bool splits = o.operand(0)[0] == '{';
  const Names parts = Operands::elements(o.operand(splits ? 0 : 1));
  if (parts.size() != 2) o.fail("unknown instruction");
  if (splits) {
    const auto part = [&](const std::string& name, const std::string& value) {
      return name == "_" ? "" : o.assign(name, half, fmt::format("static_cast<{}>({})", cpp_type(half), value));
    };
    return fmt::format("{{ const {0} whole = {1}; {2} {3} }}", cpp_type(type), o.value(1, type),
                       part(parts[0], "whole"), part(parts[1], fmt::format("whole >> {}", shift)));
  }
  return o.assign(type, fmt::format("static_cast<{0}>(static_cast<{0}>({1}) | static_cast<{0}>({2}) << {3})",
                                    cpp_type(type), o.value(parts[0], half), o.value(parts[1], half), shift));
}

// The elements of a list such as "(param0,param1)".
Names arguments(const std::string& list) {
  return list == "()" ? Names() : Operands::elements('{' + list.substr(1, list.size() - 2) + '}');
}

std::string pointers(const char* type, const char* name, const Names& list) {
  if (list.empty()) return fmt::format("{}* {} = nullptr;", type, name);
  std::string all;
  for (const std::string& one : list) all += (all.empty() ? "" : ", ") + identifier(one);
  return fmt::format("{} {}[] = {{{}}};", type, name, all);
}

// call[.uni] [(returned),] NAME[, (arguments)]
std::string call(const Operands& o) {
  std::size_t at = 0;
  Names returned, given;
  if (o.operand(0)[0] == '(') returned = arguments(o.operand(at++));
  const std::string& name = o.operand(at++);
  if (name[0] == '%') o.fail("a call through a function pointer cannot be replayed");
  bool found = false;
  for (const Kernel& kernel : o.module().kernels) found |= kernel.is_function && kernel.name == name;
  if (!found) o.fail("a function in another file cannot be replayed");
  if (at < o.count() && o.operand(at)[0] == '(') given = arguments(o.operand(at));
  return fmt::format("{{ {} {} call_{}(returns, arguments, fuse); }}",
                     pointers("unsigned char* const", "returns", returned),
                     pointers("const unsigned char* const", "arguments", given), identifier(name));
}

// brx.idx INDEX, LIST
std::string jump_by_index(const Operands& o) {
  const auto list = o.kernel().branch_targets.find(o.operand(1));
  if (list == o.kernel().branch_targets.end()) o.fail("expected a list of labels");
  std::string cases;
  for (std::size_t c = 0; c < list->second.size(); ++c)
    cases += fmt::format("case {}: goto {}; ", c, identifier(list->second[c]));
  return fmt::format("switch ({}) {{ {}default: __builtin_unreachable(); }}", o.value(0, "u32"), cases);
}

std::string statement(const Operands& o) {
  const Instruction& i = o.instruction();
  const std::string &op = i.op[0], &type = o.type();
  if (op == "bra") return fmt::format("goto {};", identifier(o.operand(0)));
  if (op == "brx") return jump_by_index(o);
  if (op == "ret") return "return;";
  if (op == "exit") {
    if (o.kernel().is_function) o.fail("cannot be replayed in a function");
    return "return;";
  }
  if (op == "call") return call(o);
  if (op == "ld" || op == "st") return memory(o);
  if (op == "mov") return move(o);
  if (op == "setp") return compare(o);
  if (op == "cvt") return convert(o);
  if (op == "cvta") return o.assign("u64", o.value(1, "u64"));
  if (one_of(op, {"and", "or", "xor", "not"})) return logic(o);
  if (op == "selp") {
    o.only({});
    return o.assign(type, fmt::format("{} ? {} : {}", o.value(3, "pred"), o.value(1, type), o.value(2, type)));
  }
  if (op == "slct") {  // slct.TYPE.s32 d, a, b, c: a if c >= 0, else b
    const std::string what = i.op.at(i.op.size() - 2);
    if (i.op.size() != 3 || type != "s32" || cpp_type(what).empty()) o.fail("unknown instruction");
    return o.assign(what, fmt::format("{} >= 0 ? {} : {}", o.value(3, type), o.value(1, what), o.value(2, what)));
  }
  if (op == "testp") {
    if (i.op.size() != 3 || !one_of(i.op[1], {"finite", "infinite", "number", "notanumber", "normal", "subnormal"}))
      o.fail("unknown instruction");
    return o.assign("pred", fmt::format("test_{}({})", i.op[1], o.value(1, type)));
  }
  if (op == "vote" && i.op == Names{"vote", "sync", "ballot", "b32"})
    return o.assign(type, fmt::format("u32{{{}}} & {}", o.value(1, "pred"), o.value(2, "u32")));
  if (one_of(type, {"f32", "f64"})) return floating_statement(o);
  if (one_of(type, {"u16", "s16", "b16", "u32", "s32", "b32", "u64", "s64", "b64"})) return integer_statement(o);
  o.fail("unknown instruction");
}

}  // namespace

std::string cpp_statement(const Module& module, const Kernel& kernel, const Instruction& instruction) {
  const std::string guard = instruction.guard.empty() ? ""
                                                      : fmt::format("if ({}{}) ", instruction.guard_negated ? "!" : "",
                                                                    identifier(instruction.guard));
  return guard + statement(Operands(module, kernel, instruction));
}

}  // namespace graze::cuda::twin
