// SPDX-License-Identifier: Apache-2.0
// OpenCL 1.2, loaded at run time, so that a build needs its headers only; and the devices that it finds.
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_1_APIS  // clGetExtensionFunctionAddress, the only function that drivers must export
#include <CL/cl_icd.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace graze::subjects {

// Why the program ends.
struct Failure : std::runtime_error {
  Failure(int exit_status, const std::string& message) : std::runtime_error(message), status(exit_status) {}
  int status;
};

// The functions of OpenCL 1.2, after a device was asked for. Later ones may be missing.
extern const cl_icd_dispatch* cl;

// Throws: Failure with the call and the error, unless that is CL_SUCCESS.
void check(cl_int error, const char* call);

// A text that a call gives.   ask(size, at, size_needed): makes the call.   Throws: Failure.
template <class Ask>
std::string text_of(const char* call, Ask ask) {
  std::size_t size = 0;
  check(ask(std::size_t{0}, nullptr, &size), call);
  std::string text(size, '\0');
  check(ask(size, text.data(), nullptr), call);
  return text.c_str();  // up to its zero
}

struct Device {
  cl_platform_id platform;
  cl_device_id id;

  std::string text(cl_device_info what) const;
  cl_device_fp_config floating(cl_device_info what) const;  // none if the device does not know the question
  bool has_double() const { return floating(CL_DEVICE_DOUBLE_FP_CONFIG) != 0; }
  // Division and square root of float, if the compiler is asked for it.
  bool rounds_correctly() const { return floating(CL_DEVICE_SINGLE_FP_CONFIG) & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT; }
};

// All devices of the library that the environment's GRAZE_OPENCL names, else of libOpenCL.so.1. It is a driver loader
// or a driver.   Throws: Failure when there is no library, or no platform.
std::vector<Device> all_devices();

// The first GPU of the platforms whose names contain the text, else their first device.   Throws: Failure.
Device chosen_device(const std::string& part_of_name);

std::string name_of(cl_platform_id platform);

}  // namespace graze::subjects
