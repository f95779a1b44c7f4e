# SPDX-License-Identifier: Apache-2.0
# Finds nvcc. Without nvcc, CMAKE_CUDA_COMPILER is false.
include(CheckLanguage)
# A campaign build without a device needs no nvcc: it runs twins, which are built from stored PTX.
file(GLOB devices /dev/nvidia[0-9]* /dev/dxg)
if(devices OR NOT GRAZE_CAMPAIGN)
  check_language(CUDA)
endif()
if(CMAKE_CUDA_COMPILER)
  # nvcc emits PTX and machine code for sm_90. On other devices (sm_75 or newer), the driver compiles the PTX.
  if(NOT CMAKE_CUDA_ARCHITECTURES)
    set(CMAKE_CUDA_ARCHITECTURES 75-virtual 90-real)
  endif()
  set(CMAKE_CUDA_STANDARD 20)
  enable_language(CUDA)
  if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake 3.25.1 does not know that nvcc supports C++20
    set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION -std=c++20)
    set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION -std=c++20)
  endif()
  message(STATUS "CUDA lanes: built with nvcc ${CMAKE_CUDA_COMPILER_VERSION} for ${CMAKE_CUDA_ARCHITECTURES}")
else()
  message(STATUS "CUDA lanes: run by their twins, on the CPU (built without nvcc); cuda-fast, which has no twin, is unavailable")
endif()
