// SPDX-License-Identifier: Apache-2.0
// The twin generator, a build tool. It reads PTX and writes C++, explicit PTX, or the PTX stored in the repository.
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>

#include "cuda/twin/generator/cpp_writer.h"
#include "cuda/twin/generator/proofs.h"
#include "cuda/twin/generator/ptx_writer.h"

using namespace graze::cuda::twin;

namespace {

constexpr char kUsage[] =
    "usage: graze_twin_generator [--rule ptxas|none|right_first] PTX FORM OUT [FORM OUT …]\n"
    "  --cpp OUT              C++ for the CPU, with the contractions of ptxas\n"
    "  --explicit OUT         the PTX with every contraction written out\n"
    "  --stored ROOT OUT      the PTX in the form stored in the repository, with paths relative to ROOT\n"
    "usage: graze_twin_generator --proofs OUT [RECORD …]\n";

void write_file(const std::string& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  if (!out.flush()) throw PtxError(path + ":0: cannot be written");
}

int run(int count, char** arguments) {
  if (count > 2 && std::strcmp(arguments[1], "--proofs") == 0) {
    std::ostringstream text;
    write_proofs(text, {arguments + 3, arguments + count});
    return write_file(arguments[2], text.str()), 0;
  }
  Rule rule = Rule::ptxas;
  int a = 1;
  if (count > 2 && std::strcmp(arguments[1], "--rule") == 0) {
    const std::string name = arguments[2];
    if (name != "ptxas" && name != "none" && name != "right_first") return std::cerr << kUsage, 2;
    rule = name == "none" ? Rule::none : name == "right_first" ? Rule::right_first : Rule::ptxas;
    a = 3;
  }
  if (a + 2 >= count) return std::cerr << kUsage, 2;
  const std::string path = arguments[a++];
  std::ifstream in(path);
  if (!in) throw PtxError(path + ":0: cannot be read");
  const Module module = read_ptx(in, path);
  while (a < count) {
    const std::string form = arguments[a++];
    const std::string root = form == "--stored" && a < count ? arguments[a++] : "";
    if (a >= count) return std::cerr << kUsage, 2;
    std::ostringstream text;
    if (form == "--cpp") {
      write_cpp(text, module, rule);
    } else if (form == "--explicit") {
      write_explicit(text, module, rule);
    } else if (form == "--stored") {
      write_stored(text, module, root);
    } else {
      return std::cerr << kUsage, 2;
    }
    write_file(arguments[a++], text.str());
  }
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    return run(count, arguments);
  } catch (const PtxError& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
