// SPDX-License-Identifier: Apache-2.0
// graze-subject-opencl answers for a subject in OpenCL C, as graze/program.h describes. Graze starts this program:
//   graze-subject-opencl FILE.cl FUNCTION f32|f64|any MODE [PLATFORM]
// To list the devices:
//   graze-subject-opencl --platforms
// FILE.cl defines int FUNCTION(const REAL* a, const REAL* b), where each triangle is nine numbers in private memory.
// The file is compiled once with -DREAL=float -DREAL3=float3 and once with -DREAL=double -DREAL3=double3. The program
// answers for each type for which this succeeds, so a function may also take only float* or only double*. FILE.cl is in
// OpenCL C 1.2, and includes no other files.
// MODE sets the compiler's freedom:
//   default  The compiler contracts as it does by default.
//   nofma    #pragma OPENCL FP_CONTRACT OFF precedes the source.
//   mad      -cl-mad-enable
//   fast     -cl-fast-relaxed-math
// In all modes but `fast`, division and square root are rounded correctly if the device can do so. The device decides
// how to treat subnormal numbers.
// PLATFORM is a part of a platform's name. Without PLATFORM, the program uses the first platform with a GPU, else the
// first with any device.
// The environment variable GRAZE_OPENCL names the library to load: a driver loader, or a driver such as
// libnvidia-opencl.so.1. The default is libOpenCL.so.1.
// Exit status: 1 a call failed; 2 wrong use; 3 no library, or no device; 4 the source does not compile.
#define GRAZE_PROGRAM_TYPES_ONLY
#include <fcntl.h>
#include <graze/program.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "subjects/channel.h"
#include "subjects/opencl/opencl.h"

namespace graze::subjects {
namespace {

int print_platforms() {
  const auto yes_no = [](bool is) { return is ? "yes" : "no"; };
  for (const Device& device : all_devices()) {
    const cl_device_fp_config single = device.floating(CL_DEVICE_SINGLE_FP_CONFIG);
    std::printf(
        "%s: %s; %s; driver %s; fp64 %s; subnormals %s; FMA %s; division and square root rounded correctly %s\n",
        name_of(device.platform).c_str(), device.text(CL_DEVICE_NAME).c_str(), device.text(CL_DEVICE_VERSION).c_str(),
        device.text(CL_DRIVER_VERSION).c_str(), yes_no(device.has_double()), yes_no(single & CL_FP_DENORM),
        yes_no(single & CL_FP_FMA), yes_no(device.rounds_correctly()));
  }
  return 0;
}

// A subject: its source, its function and the mode of the compiler.
struct Subject {
  std::string file, function, mode, source;
};

// Source text that makes the compiler name this file in its messages.
std::string line_1_of(const std::string& file) {
  std::string name;
  for (const char c : file) name += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
  return "#line 1 \"" + name + "\"\n";
}

// The subject's source, followed by a kernel that calls the function, and then the function's declaration. A missing
// function makes the call an error; other types make the declaration an error. (In C, a call with pointers to another
// type only gets a warning.)
std::string with_kernel(const Subject& subject, bool in_double) {
  std::string text;
  if (in_double) text += "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n";
  if (subject.mode == "nofma") text += "#pragma OPENCL FP_CONTRACT OFF\n";
  text += line_1_of(subject.file) + subject.source + '\n' + line_1_of("kernel that calls " + subject.function);
  return text + R"(
__kernel void graze_answer(__global const REAL* pairs, __global int* answers, uint count) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  REAL a[9], b[9];
  for (int k = 0; k < 9; ++k) {
    a[k] = pairs[18 * i + k];
    b[k] = pairs[18 * i + 9 + k];
  }
  const int answer = )" +
         subject.function + R"((a, b);
  answers[i] = answer < 0 ? -1 : answer > 0;
}
int )" + subject.function +
         "(const REAL* a, const REAL* b);\n";
}

std::string options(const Subject& subject, const Device& device, bool in_double) {
  const std::string real = in_double ? "double" : "float";
  std::string text = "-cl-std=CL1.2 -DREAL=" + real + " -DREAL3=" + real + "3";
  if (subject.mode == "mad") text += " -cl-mad-enable";
  if (subject.mode == "fast") return text + " -cl-fast-relaxed-math";
  return device.rounds_correctly() ? text + " -cl-fp32-correctly-rounded-divide-sqrt" : text;
}

// The first line of the compiler's output with the word "error", or else its first line.
std::string first_error(const std::string& log) {
  std::istringstream lines(log);
  std::string first;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("error") != line.npos) return line;
    if (first.empty()) first = line;
  }
  return first;
}

// While an object of this class exists, standard error is /dev/null, because compilers write to it.
class Quiet {
 public:
  Quiet() : kept_(dup(2)) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ >= 0 && nowhere >= 0) dup2(nowhere, 2);
    close(nowhere);
  }
  ~Quiet() {
    dup2(kept_, 2);
    close(kept_);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  int kept_;
};

// The subject, compiled for a device.
class OnDevice {
 public:
  OnDevice(const Subject& subject, const Device& device) : subject_(subject), device_(device) {
    cl_int error = CL_SUCCESS;
    context_ = cl->clCreateContext(nullptr, 1, &device.id, nullptr, nullptr, &error);
    check(error, "clCreateContext");
    queue_ = cl->clCreateCommandQueue(context_, device.id, 0, &error);
    check(error, "clCreateCommandQueue");
    pairs_ = cl->clCreateBuffer(context_, CL_MEM_READ_ONLY, kWords * 18 * sizeof(double), nullptr, &error);
    check(error, "clCreateBuffer");
    answers_ = cl->clCreateBuffer(context_, CL_MEM_READ_WRITE, kWords * sizeof(cl_int), nullptr, &error);
    check(error, "clCreateBuffer");
  }

  bool has(bool in_double) const { return kernels_[in_double].id != nullptr; }

  // Compiles the subject for float or double. Some devices compile a kernel only when it first runs, so this function
  // also runs it, but on no pairs, because the subject could fail. Returns: the first error in the source; empty if
  // there is none.
  std::string compile(bool in_double) {
    if (in_double && !device_.has_double()) return device_.text(CL_DEVICE_NAME) + " has no double";
    const std::string text = with_kernel(subject_, in_double);
    const char* source = text.c_str();
    cl_int error = CL_SUCCESS;
    const cl_program program = cl->clCreateProgramWithSource(context_, 1, &source, nullptr, &error);
    check(error, "clCreateProgramWithSource");
    const std::string flags = options(subject_, device_, in_double);
    {
      const Quiet quiet;
      error = cl->clBuildProgram(program, 1, &device_.id, flags.c_str(), nullptr, nullptr);
    }
    if (error == CL_BUILD_PROGRAM_FAILURE) return first_error(log_of(program));
    check(error, "clBuildProgram");
    Kernel& kernel = kernels_[in_double];
    kernel.id = cl->clCreateKernel(program, "graze_answer", &error);
    check(error, "clCreateKernel");
    check(cl->clGetKernelWorkGroupInfo(kernel.id, device_.id, CL_KERNEL_WORK_GROUP_SIZE, sizeof kernel.group_size,
                                       &kernel.group_size, nullptr),
          "clGetKernelWorkGroupInfo");
    kernel.group_size = std::min<std::size_t>(kernel.group_size, 64);
    launch(0, in_double);
    cl_int unread = 0;
    read(&unread, sizeof unread);  // waits until the kernel has run
    return "";
  }

  // Returns: the answers for the pairs.   Requires: has(in_double); 0 < count <= kWords.
  std::vector<cl_int> answer(const void* pairs, cl_uint count, bool in_double) const {
    constexpr cl_int kNone = 2;  // marks answers that the kernel does not write
    std::vector<cl_int> answers(count, kNone);
    write(pairs_, pairs, 18 * (in_double ? sizeof(double) : sizeof(float)) * count);
    write(answers_, answers.data(), count * sizeof(cl_int));
    launch(count, in_double);
    read(answers.data(), count * sizeof(cl_int));
    if (std::any_of(answers.begin(), answers.end(), [](cl_int said) { return said < -1 || said > 1; }))
      throw Failure(1, "the kernel left a pair without an answer");
    return answers;
  }

 private:
  struct Kernel {
    cl_kernel id = nullptr;
    std::size_t group_size = 0;  // the same for all runs, because some devices compile for each size
  };

  // Starts the kernel in whole groups on the pairs in the device's memory.
  void launch(cl_uint count, bool in_double) const {
    const Kernel& kernel = kernels_[in_double];
    const std::size_t groups = std::max<std::size_t>(1, (count + kernel.group_size - 1) / kernel.group_size);
    const std::size_t items = groups * kernel.group_size;
    check(cl->clSetKernelArg(kernel.id, 0, sizeof pairs_, &pairs_), "clSetKernelArg");
    check(cl->clSetKernelArg(kernel.id, 1, sizeof answers_, &answers_), "clSetKernelArg");
    check(cl->clSetKernelArg(kernel.id, 2, sizeof count, &count), "clSetKernelArg");
    check(cl->clEnqueueNDRangeKernel(queue_, kernel.id, 1, nullptr, &items, &kernel.group_size, 0, nullptr, nullptr),
          "clEnqueueNDRangeKernel");
  }

  void read(void* answers, std::size_t bytes) const {
    check(cl->clEnqueueReadBuffer(queue_, answers_, CL_TRUE, 0, bytes, answers, 0, nullptr, nullptr),
          "clEnqueueReadBuffer");
  }

  void write(cl_mem to, const void* from, std::size_t bytes) const {
    check(cl->clEnqueueWriteBuffer(queue_, to, CL_TRUE, 0, bytes, from, 0, nullptr, nullptr), "clEnqueueWriteBuffer");
  }

  std::string log_of(cl_program program) const {
    return text_of("clGetProgramBuildInfo", [&](auto... to) {
      return cl->clGetProgramBuildInfo(program, device_.id, CL_PROGRAM_BUILD_LOG, to...);
    });
  }

  const Subject& subject_;
  Device device_;
  cl_context context_;
  cl_command_queue queue_;
  cl_mem pairs_, answers_;
  Kernel kernels_[2];  // for float and double
};

void write_all(std::FILE* out, const void* from, std::size_t bytes) {
  if (std::fwrite(from, 1, bytes, out) != bytes || std::fflush(out) != 0)
    throw Failure(1, std::string("cannot write answers: ") + std::strerror(errno));
}

// Answers questions until the input ends.
void serve(const OnDevice& subject, std::FILE* out) {
  const graze_hello hello{
      {'g', 'r', 'a', 'z', 'e', ' ', '1', '\n'}, 1, (subject.has(false) ? 1u : 0u) | (subject.has(true) ? 2u : 0u)};
  write_all(out, &hello, sizeof hello);
  graze_question asked;
  std::vector<std::uint32_t> places(kWords);
  std::vector<double> pairs(kWords * 18);
  while (std::fread(&asked, sizeof asked, 1, stdin) == 1) {
    const bool in_double = asked.is_double;
    const std::size_t size = 18 * (in_double ? sizeof(double) : sizeof(float));
    if (asked.count > kWords) throw Failure(1, "a question has too many pairs");
    if (!subject.has(in_double)) throw Failure(1, "a question has numbers of a type that the subject does not take");
    if (std::fread(places.data(), sizeof places[0], asked.count, stdin) != asked.count ||
        std::fread(pairs.data(), size, asked.count, stdin) != asked.count)
      throw Failure(1, "a question is incomplete");
    if (asked.count == 0) continue;
    const std::vector<cl_int> answers = subject.answer(pairs.data(), asked.count, in_double);
    std::vector<std::uint64_t> words;
    for (std::size_t i = 0; i < answers.size(); ++i)
      words.push_back(word_of(asked.nonce, places[i] & 1, places[i] >> 1, static_cast<signed char>(answers[i])));
    write_all(out, words.data(), words.size() * sizeof words[0]);
  }
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1 && arguments[0] == "--platforms") return print_platforms();
  const auto one_of = [](const std::string& word, std::initializer_list<const char*> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  if (arguments.size() < 4 || arguments.size() > 5 || !one_of(arguments[2], {"f32", "f64", "any"}) ||
      !one_of(arguments[3], {"default", "nofma", "mad", "fast"}))
    throw Failure(2, "expected FILE.cl FUNCTION f32|f64|any default|nofma|mad|fast [PLATFORM], or --platforms");
  if (arguments[1].find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") !=
      std::string::npos)
    throw Failure(2, "expected the name of a function, found " + arguments[1]);
  // Sends the output of drivers and kernels to standard error, so that it is not read as an answer.
  std::FILE* out = fdopen(dup(1), "wb");
  if (!out || dup2(2, 1) < 0) throw Failure(1, std::string("cannot write answers: ") + std::strerror(errno));
  Subject subject{arguments[0], arguments[1], arguments[3], ""};
  std::ifstream file(subject.file);
  std::getline(file, subject.source, '\0');
  if (!file.is_open() || file.bad()) throw Failure(1, "cannot read " + subject.file + ": " + std::strerror(errno));
  OnDevice on_device(subject, chosen_device(arguments.size() == 5 ? arguments[4] : ""));
  std::string error;
  for (const bool in_double : {false, true}) {
    if (arguments[2] == (in_double ? "f32" : "f64")) continue;
    const std::string first = on_device.compile(in_double);
    if (first != error && !first.empty()) error += (error.empty() ? "" : "; ") + first;
  }
  if (!on_device.has(false) && !on_device.has(true)) throw Failure(4, subject.file + " does not compile: " + error);
  serve(on_device, out);
  return 0;
}

}  // namespace
}  // namespace graze::subjects

int main(int argc, char** argv) {
  try {
    return graze::subjects::run({argv + 1, argv + argc});
  } catch (const graze::subjects::Failure& failure) {
    std::fprintf(stderr, "graze-subject-opencl: %s\n", failure.what());
    return failure.status;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "graze-subject-opencl: %s\n", error.what());
    return 1;
  }
}
