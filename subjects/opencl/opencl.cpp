// SPDX-License-Identifier: Apache-2.0
#include "subjects/opencl/opencl.h"

#include <dlfcn.h>

#include <cstdlib>
#include <utility>

namespace graze::subjects {

const cl_icd_dispatch* cl;

namespace {

const char* name_of(cl_int error) {
  static constexpr std::pair<cl_int, const char*> kNames[] = {
      {CL_DEVICE_NOT_AVAILABLE, "CL_DEVICE_NOT_AVAILABLE"},
      {CL_COMPILER_NOT_AVAILABLE, "CL_COMPILER_NOT_AVAILABLE"},
      {CL_MEM_OBJECT_ALLOCATION_FAILURE, "CL_MEM_OBJECT_ALLOCATION_FAILURE"},
      {CL_OUT_OF_RESOURCES, "CL_OUT_OF_RESOURCES"},
      {CL_OUT_OF_HOST_MEMORY, "CL_OUT_OF_HOST_MEMORY"},
      {CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST, "CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST"},
      {CL_INVALID_BUILD_OPTIONS, "CL_INVALID_BUILD_OPTIONS"}};
  for (const auto& [code, name] : kNames) {
    if (code == error) return name;
  }
  return "error";
}

std::string library_name() {
  const char* name = std::getenv("GRAZE_OPENCL");
  return name && *name ? name : "libOpenCL.so.1";
}

template <class Function>
bool find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  return function != nullptr;
}

// Loads the library, sets `cl`, and returns the platforms. A driver loader exports all functions. A driver exports only
// one function, which finds the function that returns the platforms. A driver's platform begins with the address of its
// function table.   Throws: Failure if there is no library or no platform.
std::vector<cl_platform_id> load_platforms() {
  static cl_icd_dispatch table{};
  const std::string name = library_name();
  void* library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    const char* why = dlerror();
    throw Failure(3,
                  std::string("no OpenCL: ") + why + " (install ocl-icd-libopencl1 and a driver, or set GRAZE_OPENCL)");
  }
  const auto get = [&](const char* function, auto& to) {
    if (!find(library, function, to))
      throw Failure(3, name + " has no " + function + ", so it is not an OpenCL library");
  };
  cl_api_clGetPlatformIDs get_platforms = nullptr;
  const bool is_driver = !find(library, "clGetPlatformIDs", get_platforms);
  if (is_driver) {
    cl_api_clGetExtensionFunctionAddress extension = nullptr;
    get("clGetExtensionFunctionAddress", extension);
    get_platforms = reinterpret_cast<cl_api_clGetPlatformIDs>(extension("clIcdGetPlatformIDsKHR"));
    if (!get_platforms) throw Failure(3, name + " has no clIcdGetPlatformIDsKHR");
  }
  cl_uint count = 0;
  if (get_platforms(0, nullptr, &count) != CL_SUCCESS || count == 0)
    throw Failure(3, name + " has no platform (install a driver, such as pocl-opencl-icd)");
  std::vector<cl_platform_id> platforms(count);
  check(get_platforms(count, platforms.data(), nullptr), "clGetPlatformIDs");
  if (is_driver) {
    cl = *reinterpret_cast<const cl_icd_dispatch* const*>(platforms[0]);
    return platforms;
  }
  get("clGetPlatformInfo", table.clGetPlatformInfo);
  get("clGetDeviceIDs", table.clGetDeviceIDs);
  get("clGetDeviceInfo", table.clGetDeviceInfo);
  get("clCreateContext", table.clCreateContext);
  get("clCreateCommandQueue", table.clCreateCommandQueue);
  get("clCreateBuffer", table.clCreateBuffer);
  get("clCreateProgramWithSource", table.clCreateProgramWithSource);
  get("clBuildProgram", table.clBuildProgram);
  get("clGetProgramBuildInfo", table.clGetProgramBuildInfo);
  get("clCreateKernel", table.clCreateKernel);
  get("clSetKernelArg", table.clSetKernelArg);
  get("clGetKernelWorkGroupInfo", table.clGetKernelWorkGroupInfo);
  get("clEnqueueWriteBuffer", table.clEnqueueWriteBuffer);
  get("clEnqueueNDRangeKernel", table.clEnqueueNDRangeKernel);
  get("clEnqueueReadBuffer", table.clEnqueueReadBuffer);
  cl = &table;
  return platforms;
}

std::vector<Device> devices_of(const std::vector<cl_platform_id>& platforms, cl_device_type type) {
  std::vector<Device> devices;
  for (const cl_platform_id platform : platforms) {
    cl_uint count = 0;
    const cl_int error = cl->clGetDeviceIDs(platform, type, 0, nullptr, &count);
    if (error == CL_DEVICE_NOT_FOUND || (error == CL_SUCCESS && count == 0)) continue;
    check(error, "clGetDeviceIDs");
    std::vector<cl_device_id> ids(count);
    check(cl->clGetDeviceIDs(platform, type, count, ids.data(), nullptr), "clGetDeviceIDs");
    for (const cl_device_id id : ids) devices.push_back({platform, id});
  }
  return devices;
}

}  // namespace

void check(cl_int error, const char* call) {
  if (error != CL_SUCCESS)
    throw Failure(1, std::string(call) + " failed: " + name_of(error) + " (" + std::to_string(error) + ')');
}

std::string Device::text(cl_device_info what) const {
  return text_of("clGetDeviceInfo", [&](auto... to) { return cl->clGetDeviceInfo(id, what, to...); });
}

cl_device_fp_config Device::floating(cl_device_info what) const {
  cl_device_fp_config config = 0;
  return cl->clGetDeviceInfo(id, what, sizeof config, &config, nullptr) == CL_SUCCESS ? config : 0;
}

std::string name_of(cl_platform_id platform) {
  return text_of("clGetPlatformInfo",
                 [&](auto... to) { return cl->clGetPlatformInfo(platform, CL_PLATFORM_NAME, to...); });
}

std::vector<Device> all_devices() { return devices_of(load_platforms(), CL_DEVICE_TYPE_ALL); }

Device chosen_device(const std::string& part_of_name) {
  std::vector<cl_platform_id> platforms = load_platforms();
  std::erase_if(platforms, [&](cl_platform_id p) { return name_of(p).find(part_of_name) == std::string::npos; });
  for (const cl_device_type type : {cl_device_type{CL_DEVICE_TYPE_GPU}, cl_device_type{CL_DEVICE_TYPE_ALL}}) {
    const std::vector<Device> devices = devices_of(platforms, type);
    if (!devices.empty()) return devices[0];
  }
  throw Failure(3, "no OpenCL platform" + (part_of_name.empty() ? "" : " named " + part_of_name) +
                       " has a device; see --platforms");
}

}  // namespace graze::subjects
