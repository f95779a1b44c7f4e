// SPDX-License-Identifier: Apache-2.0
// How nvcc contracts. The front end (cicc) turns a*b + c into fma.rn, but a*b - c*d and x - a*b into mul and sub
// without a rounding suffix, which ptxas at -O1 and above may contract. The rule of ptxas, for m = a*b:
//
//   PTX, all in one block                 machine code                  row
//   m - x, x - m, m + x, x + m            fma                           single product
//   m1 - m2, m1 + m2                      fma of the left, mul          left before right
//   m1 - m2, and m1 in m1 + m3            fma of m2, of m3; mul m1      a product with one use before others
//   m - x, m + y, …                       one fma for each              shared by additions alone: duplicated
//   m - x, m stored, compared, multiplied add, mul                      not fused
//   m - x, m the addend of an fma         add, mul                      not fused
//   m + m, m - m, two equal products      add, mul                      not fused
//   -m + x, x - (-m), a copy of m         fma                           through neg and mov
//   |m| + x                               add, mul                      not through abs
//   m in another block than the addition  add, mul                      not fused, also if-converted or in a loop
//   m computed under a guard              add, mul                      not fused
//   the addition under a guard            fma                           fused
//   .rn on either                         add, mul                      not fused
//   .ftz on one but not the other         add, mul                      not fused
//   .sat on the addition                  fma.sat                       fused
//
// The order in which ptxas contracts additions matters only if they share products. ptxas first contracts the additions
// with a product that has only one use, then the other additions in program order. If both operands are products, it
// fuses the product with fewer uses, or the left product if their uses are equal.
//
// Evidence, with ptxas 13.0.88:
// - Each row's machine code for sm_90, in f32 and f64, was disassembled and read.
// - After this pass has written out their contractions, random straight-line programs and most of the project's kernels
//   give the same machine code, instruction for instruction. All kernels have the same counts of fused and unfused
//   operations (static_check.test.cpp).
// - The twins give the same verdicts and intermediate bits as an H100 and an H200 (cuda/proofs).
#include "cuda/twin/generator/contraction.h"

#include <algorithm>
#include <map>
#include <optional>

#include "cuda/twin/generator/flow.h"

namespace graze::cuda::twin {
namespace {

bool is_float(const Instruction& i) { return i.is_operation() && (i.op.back() == "f32" || i.op.back() == "f64"); }
bool is_rounded(const Instruction& i) { return i.has("rn") || i.has("rz") || i.has("rm") || i.has("rp"); }

bool is_product(const Instruction& i) {
  return is_float(i) && i.op[0] == "mul" && !is_rounded(i) && !i.has("sat") && i.guard.empty();
}
bool is_addition(const Instruction& i) {
  return is_float(i) && (i.op[0] == "add" || i.op[0] == "sub") && !is_rounded(i);
}
bool is_copy(const Instruction& i) {
  return is_float(i) && i.guard.empty() && (i.op[0] == "mov" || (i.op[0] == "neg" && !i.has("ftz")));
}

struct Product {
  std::size_t uses = 0;         // uses in additions
  bool used_otherwise = false;  // has another use, such as the addend of a fusion
};

// The operands of an addition: for each operand that is a product, the product's index in Kernel::body.
struct Operands {
  std::optional<std::size_t> product[2];
  bool negated[2] = {false, false};
  bool fused = false;
};

struct Fusion {
  std::size_t product;
  int operand;
  bool negated;
};

// Finds the products and additions of one block, and fuses them by the rule.
class BlockPass {
 public:
  BlockPass(const Kernel& kernel, const Block& block, Rule rule) : kernel_(kernel), block_(block), rule_(rule) {
    find_uses();
  }

  std::map<std::size_t, Fusion> fusions() {
    if (rule_ == Rule::none) return {};
    for (bool single : {true, false}) {
      for (auto& [place, operands] : additions_) {
        if (!operands.fused) fuse(place, operands, single);
      }
    }
    return result_;
  }

 private:
  struct Value {
    std::size_t product;
    bool negated;
  };

  void find_uses() {
    std::map<std::string, Value> holds;  // registers that hold a product of this block
    for (std::size_t place : block_.instructions) {
      const Instruction& i = kernel_.body[place];
      if (!i.is_operation()) continue;
      if (is_addition(i)) {
        note_addition(place, i, holds);
      } else if (!(is_copy(i) && holds.count(i.operands[1]))) {
        for (const std::string& name : registers_read(i)) {
          if (const auto at = holds.find(name); at != holds.end()) products_[at->second.product].used_otherwise = true;
        }
      }
      std::optional<Value> copied;
      if (is_copy(i) && holds.count(i.operands[1]))
        copied = {holds.at(i.operands[1]).product, holds.at(i.operands[1]).negated != (i.op[0] == "neg")};
      for (const std::string& name : registers_written(i)) {
        if (i.guard.empty()) {
          holds.erase(name);
        } else if (const auto at = holds.find(name); at != holds.end()) {  // the register may still hold the product
          products_[at->second.product].used_otherwise = true;
        }
      }
      if (is_product(i)) {
        products_[place];
        holds[i.operands[0]] = {place, false};
      } else if (copied) {
        holds[i.operands[0]] = *copied;
      }
    }
    for (const auto& [name, value] : holds) {
      if (block_.alive_at_end.count(name)) products_[value.product].used_otherwise = true;
    }
  }

  bool same_factors(std::size_t p, std::size_t q) const {
    const auto &a = kernel_.body[p].operands, &b = kernel_.body[q].operands;
    return p == q || (a[1] == b[1] && a[2] == b[2]) || (a[1] == b[2] && a[2] == b[1]);
  }

  void note_addition(std::size_t place, const Instruction& i, const std::map<std::string, Value>& holds) {
    Operands& operands = additions_[place];
    for (int o = 0; o < 2; ++o) {
      const auto at = holds.find(i.operands[static_cast<std::size_t>(o + 1)]);
      if (at == holds.end()) continue;
      const Instruction& product = kernel_.body[at->second.product];
      if (product.has("ftz") != i.has("ftz") || product.op.back() != i.op.back()) {
        products_[at->second.product].used_otherwise = true;
        continue;
      }
      operands.product[o] = at->second.product;
      operands.negated[o] = at->second.negated;
    }
    if (operands.product[0] && operands.product[1] && same_factors(*operands.product[0], *operands.product[1])) {
      for (const auto& product : operands.product) products_[*product].used_otherwise = true;
      operands.product[0] = operands.product[1] = std::nullopt;
    }
    for (int o = 0; o < 2; ++o) {
      if (operands.product[o]) ++products_[*operands.product[o]].uses;
    }
  }

  // The product's number of uses if it may be fused into this addition; otherwise nullopt.
  std::optional<std::size_t> uses(const std::optional<std::size_t>& product, bool single) const {
    if (!product) return {};
    const Product& p = products_.at(*product);
    if (p.used_otherwise || (single && p.uses != 1)) return {};
    return p.uses;
  }

  void fuse(std::size_t place, Operands& operands, bool single) {
    const auto left = uses(operands.product[0], single), right = uses(operands.product[1], single);
    if (!left && !right) return;
    int chosen = !left ? 1 : !right ? 0 : *left < *right ? 0 : *right < *left ? 1 : rule_ == Rule::right_first ? 1 : 0;
    const std::size_t product = *operands.product[chosen];
    if (operands.product[1 - chosen]) products_[*operands.product[1 - chosen]].used_otherwise = true;
    operands.fused = true;
    result_[place] = {product, chosen + 1, operands.negated[chosen]};
  }

  const Kernel& kernel_;
  const Block& block_;
  Rule rule_;
  std::map<std::size_t, Product> products_;
  std::map<std::size_t, Operands> additions_;
  std::map<std::size_t, Fusion> result_;
};

// Rewrites the kernel: writes out the fusions, and rounds all other operations.
class Rewriter {
 public:
  Rewriter(const Module& module, const Kernel& kernel, const std::map<std::size_t, Fusion>& fusions,
           const std::map<std::size_t, std::size_t>& order)
      : module_(module), kernel_(kernel), fusions_(fusions), order_(order) {}

  Contracted rewrite() {
    result_.kernel = kernel_;
    result_.kernel.body.clear();
    for (const auto& [addition, fusion] : fusions_) keep_factors(addition, fusion);
    for (std::size_t place = 0; place < kernel_.body.size(); ++place) {
      if (const auto fusion = fusions_.find(place); fusion != fusions_.end()) {
        write_fused(kernel_.body[place], fusion->second);
      } else {
        write_unfused(place);
      }
    }
    for (const auto& [type, count] : fresh_count_) result_.kernel.registers["%graze_" + type + "_"] = {type, count};
    return std::move(result_);
  }

 private:
  std::string fresh(const std::string& type) { return "%graze_" + type + "_" + std::to_string(fresh_count_[type]++); }

  // Copies factors that are overwritten between the product and its addition.
  void keep_factors(std::size_t addition, const Fusion& fusion) {
    const Instruction& product = kernel_.body[fusion.product];
    auto& names = factors_[fusion.product];
    if (names.empty()) names = {product.operands[1], product.operands[2]};
    for (std::size_t place = 0; place < kernel_.body.size(); ++place) {
      if (!order_.count(place) || order_.at(place) <= order_.at(fusion.product) ||
          order_.at(place) >= order_.at(addition))
        continue;
      for (const std::string& written : registers_written(kernel_.body[place])) {
        for (std::size_t f = 0; f < 2; ++f) {
          if (names[f] == written) {
            copies_[fusion.product].push_back({fresh(product.op.back()), names[f]});
            names[f] = copies_[fusion.product].back().first;
          }
        }
      }
    }
    if (product.operands[0] == names[0] || product.operands[0] == names[1]) {  // as in m = m * b
      for (std::size_t f = 0; f < 2; ++f) {
        if (names[f] == product.operands[0]) {
          copies_[fusion.product].push_back({fresh(product.op.back()), names[f]});
          names[f] = copies_[fusion.product].back().first;
        }
      }
    }
  }

  Instruction derived(const Instruction& from, std::vector<std::string> op, std::vector<std::string> operands) const {
    Instruction i = from;
    i.op = std::move(op);
    i.operands = std::move(operands);
    return i;
  }

  void add_site(Instruction& fma, bool by_ptxas) {
    fma.site = static_cast<int>(result_.sites.size());
    result_.sites.push_back({by_ptxas, fma.line, fma.source});
  }

  std::string negated(const Instruction& at, const std::string& operand) {
    const std::string name = fresh(at.op.back());
    Instruction neg = derived(at, {"neg", at.op.back()}, {name, operand});
    neg.guard.clear();
    result_.kernel.body.push_back(std::move(neg));
    return name;
  }

  // Writes d = ±a*b ± c. A sub negates its second operand, which may be the product or the addend.
  void write_fused(const Instruction& addition, const Fusion& fusion) {
    const bool subtracts = addition.op[0] == "sub";
    auto factors = factors_.at(fusion.product);
    std::string addend = addition.operands[fusion.operand == 1 ? 2 : 1];
    if (fusion.negated != (subtracts && fusion.operand == 2)) factors[0] = negated(addition, factors[0]);
    if (subtracts && fusion.operand == 1) addend = negated(addition, addend);
    std::vector<std::string> op(addition.op);
    op[0] = "fma";
    op.insert(op.begin() + 1, "rn");
    Instruction fma = derived(addition, std::move(op), {addition.operands[0], factors[0], factors[1], addend});
    add_site(fma, true);
    result_.kernel.body.push_back(std::move(fma));
  }

  void write_unfused(std::size_t place) {
    for (const auto& [copy, original] : copies_[place]) {
      const Instruction& at = kernel_.body[place];
      result_.kernel.body.push_back(derived(at, {"mov", at.op.back()}, {copy, original}));
    }
    Instruction i = kernel_.body[place];
    if (is_float(i) && (i.op[0] == "mul" || i.op[0] == "add" || i.op[0] == "sub") && !is_rounded(i))
      i.op.insert(i.op.begin() + 1, "rn");
    if (i.has("approx") || i.has("full"))  // ptxas expands the instruction and contracts the expansion
      throw PtxError(module_.path + ":" + std::to_string(i.line) + ": cannot be replayed: " + text(i));
    if (is_float(i) && i.op[0] == "mad")
      throw PtxError(module_.path + ":" + std::to_string(i.line) + ": mad leaves the rounding open: " + text(i));
    if (is_float(i) && i.op[0] == "fma" && i.has("rn") && !i.by_hand) add_site(i, false);
    result_.kernel.body.push_back(std::move(i));
  }

  const Module& module_;
  const Kernel& kernel_;
  const std::map<std::size_t, Fusion>& fusions_;
  const std::map<std::size_t, std::size_t>& order_;  // index in Kernel::body to position in the order of execution
  Contracted result_;
  std::map<std::string, int> fresh_count_;
  std::map<std::size_t, std::vector<std::string>> factors_;
  std::map<std::size_t, std::vector<std::pair<std::string, std::string>>> copies_;
};

}  // namespace

Contracted contract(const Module& module, const Kernel& kernel, Rule rule) {
  std::map<std::size_t, Fusion> fusions;
  std::map<std::size_t, std::size_t> order;
  for (const Block& block : blocks(module, kernel)) {
    for (std::size_t place : block.instructions) order[place] = order.size();
    fusions.merge(BlockPass(kernel, block, rule).fusions());
  }
  return Rewriter(module, kernel, fusions, order).rewrite();
}

}  // namespace graze::cuda::twin
