// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cuda/twin/generator/cpp_operands.h"

namespace graze::cuda::twin {
namespace {

// The rounding mode: "rn", "rz", "rm", "rp", or empty.
std::string rounding_of(const Instruction& i) {
  for (const char* mode : {"rn", "rz", "rm", "rp"}) {
    if (i.has(mode)) return mode;
  }
  return "";
}

// The call for an operation in one rounding mode: "add(…)", "mul_ftz(…)", "rounded_sqrt<Rounding::rm>(…)".
std::string rounded_operation(const Operands& o, const std::string& arguments) {
  const Instruction& i = o.instruction();
  const std::string& op = i.op[0];
  const std::string mode = rounding_of(i);
  const bool ftz = i.has("ftz");
  if (mode.empty()) o.fail("the rounding is left open");
  if (mode != "rn") return fmt::format("rounded_{}<Rounding::{}, {}>({})", op, mode, ftz ? "true" : "false", arguments);
  if (op == "fma" && i.site < 0) return fmt::format("fma{}({})", ftz ? "_ftz" : "", arguments);
  if (op == "fma") return fmt::format("fuse{}({}, {})", ftz ? ".flushing" : "", i.site, arguments);
  if (op == "rcp") return fmt::format("div{}({}{{1}}, {})", ftz ? "_ftz" : "", cpp_type(o.type()), arguments);
  if (ftz && one_of(op, {"mul", "div"})) return fmt::format("{}_ftz({})", op, arguments);
  const std::string result = fmt::format("{}({})", op, arguments);
  return ftz && one_of(op, {"add", "sub"}) ? fmt::format("flushed({})", result) : result;
}

// Writes an integer mul or mad, with the low half, the high half or the whole product.
std::string product(const Operands& o) {
  const Instruction& i = o.instruction();
  const std::string& type = o.type();
  o.only({"lo", "hi", "wide"});
  const bool wide = i.has("wide");
  const std::string result_type = wide ? type.substr(0, 1) + std::to_string(16 * bytes(type)) : type;
  if (!wide && !i.has("lo") && !i.has("hi")) o.fail("unknown modifier");
  std::string result = fmt::format("mul_{}<{}>({}, {})",
                                   wide          ? "wide"
                                   : i.has("lo") ? "lo"
                                                 : "hi",
                                   cpp_type(type), o.value(1, type), o.value(2, type));
  if (i.op[0] == "mad") result = fmt::format("add<{}>({}, {})", cpp_type(result_type), result, o.value(3, result_type));
  return o.assign(result_type, result);
}

// Writes an operation on bits; returns an empty text for other operations.
std::string bit_statement(const Operands& o) {
  const Instruction& i = o.instruction();
  const std::string &op = i.op[0], &type = o.type();
  const auto is = [&](std::initializer_list<const char*> types) {
    if (!one_of(type, types)) o.fail("unknown instruction");
  };
  if (one_of(op, {"popc", "clz"})) {
    is({"b32", "b64"});
    o.only({});
    return o.assign("u32", fmt::format("{}<{}>({})", op, cpp_type(type), o.value(1, type)));
  }
  if (op == "brev") {
    is({"b32", "b64"});
    o.only({});
    return o.assign(type, fmt::format("brev<{}>({})", cpp_type(type), o.value(1, type)));
  }
  if (op == "bfind") {
    is({"u32", "s32", "u64", "s64"});
    o.only({"shiftamt"});
    return o.assign(
        "u32", fmt::format("bfind{}<{}>({})", i.has("shiftamt") ? "_shift" : "", cpp_type(type), o.value(1, type)));
  }
  if (op == "bfe") {
    is({"u32", "s32", "u64", "s64"});
    o.only({});
    return o.assign(type, fmt::format("bfe<{}>({}, {}, {})", cpp_type(type), o.value(1, type), o.value(2, "u32"),
                                      o.value(3, "u32")));
  }
  if (op == "bfi") {
    is({"b32", "b64"});
    o.only({});
    return o.assign(type, fmt::format("bfi<{}>({}, {}, {}, {})", cpp_type(type), o.value(1, type), o.value(2, type),
                                      o.value(3, "u32"), o.value(4, "u32")));
  }
  if (op == "prmt") {
    is({"b32"});
    o.only({});
    return o.assign(type, fmt::format("prmt({}, {}, {})", o.value(1, type), o.value(2, type), o.value(3, type)));
  }
  if (op == "shf") {
    is({"b32"});
    o.only({"l", "r", "wrap", "clamp"});
    if (i.op.size() != 4) o.fail("unknown instruction");
    return o.assign(type, fmt::format("shf_{}({}, {}, {}({}))", i.op[1], o.value(1, type), o.value(2, type), i.op[2],
                                      o.value(3, "u32")));
  }
  if (op == "lop3") {
    is({"b32"});
    o.only({});
    return o.assign(type, fmt::format("lop3({}, {}, {}, {})", o.value(1, type), o.value(2, type), o.value(3, type),
                                      o.value(4, "u32")));
  }
  if (op == "cnot") {
    o.only({});
    return o.assign(type, fmt::format("static_cast<{}>({} == 0)", cpp_type(type), o.value(1, type)));
  }
  return "";
}

}  // namespace

std::string floating_statement(const Operands& o) {
  const Instruction& i = o.instruction();
  const std::string &op = i.op[0], &type = o.type();
  const bool ftz = i.has("ftz");
  if (ftz && type != "f32") o.fail("unknown modifier .ftz");
  const auto argument = [&](std::size_t at) {
    return ftz ? fmt::format("flushed({})", o.value(at, type)) : o.value(at, type);
  };
  std::string result;
  if (one_of(op, {"add", "sub", "mul", "fma", "div", "sqrt", "rcp"})) {
    if (one_of(op, {"div", "sqrt", "rcp"})) {
      o.only({"rn", "rz", "rm", "rp", "ftz"});
    } else {
      o.only({"rn", "rz", "rm", "rp", "ftz", "sat"});
    }
    std::string arguments = argument(1);
    if (!one_of(op, {"sqrt", "rcp"})) arguments += ", " + argument(2);
    if (op == "fma") arguments += ", " + argument(3);
    result = rounded_operation(o, arguments);
  } else if (one_of(op, {"min", "max"})) {
    o.only({"ftz", "NaN"});
    result = fmt::format("{}{}({}, {})", op, i.has("NaN") ? "_nan" : "", argument(1), argument(2));
  } else if (one_of(op, {"neg", "abs"})) {
    o.only({"ftz"});
    result = fmt::format("{}({})", op, argument(1));
  } else if (op == "copysign") {
    o.only({});
    result = fmt::format("copysign({}, {})", argument(1), argument(2));
  } else {
    o.fail(one_of(op, {"ex2", "lg2", "sin", "cos", "tanh", "rsqrt"}) ? "cannot be replayed" : "unknown instruction");
  }
  if (i.has("sat")) result = fmt::format("saturated({})", result);
  return o.assign(type, result);
}

std::string integer_statement(const Operands& o) {
  const std::string &op = o.instruction().op[0], &type = o.type();
  if (one_of(op, {"mul", "mad"})) return product(o);
  if (std::string bits = bit_statement(o); !bits.empty()) return bits;
  o.only({});
  const std::string spelled = cpp_type(type);
  if (one_of(op, {"add", "sub", "min", "max", "div", "rem"}))
    return o.assign(type, fmt::format("{}<{}>({}, {})",
                                      op == "div"   ? "quotient"
                                      : op == "rem" ? "remainder"
                                                    : op,
                                      spelled, o.value(1, type), o.value(2, type)));
  if (one_of(op, {"neg", "abs"})) return o.assign(type, fmt::format("{}<{}>({})", op, spelled, o.value(1, type)));
  if (one_of(op, {"shl", "shr"}))
    return o.assign(type, fmt::format("{}<{}>({}, {})", op, spelled, o.value(1, type), o.value(2, "u32")));
  if (op == "sad")
    return o.assign(type, fmt::format("add<{0}>({1}, sad<{0}>({2}, {3}))", spelled, o.value(3, type), o.value(1, type),
                                      o.value(2, type)));
  o.fail("unknown instruction");
}

}  // namespace graze::cuda::twin
