// SPDX-License-Identifier: Apache-2.0
// Finds OpenCL devices. Loads OpenCL 1.2 at run time, so that building needs only its headers.
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_1_APIS  // clGetExtensionFunctionAddress, the only function that drivers must export
#include <CL/cl_icd.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace graze::subjects {

// The reason why the program ends, and its exit status.
struct Failure : std::runtime_error {
  Failure(int exit_status, const std::string& message) : std::runtime_error(message), status(exit_status) {}
  int status;
};

// The functions of OpenCL 1.2, once all_devices or chosen_device has loaded them. Later functions may be null.
extern const cl_icd_dispatch* cl;

// Throws: Failure that names the call and the error, unless the error is CL_SUCCESS.
void check(cl_int error, const char* call);

// The text that a call returns.   ask(size, at, size_needed): makes the call.   Throws: Failure.
template <class Ask>
std::string text_of(const char* call, Ask ask) {
  std::size_t size = 0;
  check(ask(std::size_t{0}, nullptr, &size), call);
  std::string text(size, '\0');
  check(ask(size, text.data(), nullptr), call);
  return text.c_str();  // without the terminating zero
}

struct Device {
  cl_platform_id platform;
  cl_device_id id;

  std::string text(cl_device_info what) const;
  cl_device_fp_config floating(cl_device_info what) const;  // 0 if the device does not know `what`
  bool has_double() const { return floating(CL_DEVICE_DOUBLE_FP_CONFIG) != 0; }
  // Whether the device can round division and square root of float correctly, if the compiler is told to.
  bool rounds_correctly() const { return floating(CL_DEVICE_SINGLE_FP_CONFIG) & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT; }
};

// All devices of the library that the environment variable GRAZE_OPENCL names, or else of libOpenCL.so.1. The library
// is a driver loader or a driver.   Throws: Failure if there is no library or no platform.
std::vector<Device> all_devices();

// The first GPU on the platforms whose names contain the text; without a GPU, the first device on these platforms.
// Throws: Failure.
Device chosen_device(const std::string& part_of_name);

std::string name_of(cl_platform_id platform);

}  // namespace graze::subjects
