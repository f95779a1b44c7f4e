// SPDX-License-Identifier: Apache-2.0
// `graze_write_styles FOLDER` writes the builds of cuda/subject/styles to a folder, for a machine with a device.
#include <exception>
#include <iostream>

#include "cuda/subject/styles_testing.h"

int main(int count, char** arguments) {
  if (count != 2) return std::cerr << "usage: graze_write_styles FOLDER\n", 2;
  try {
    graze::cuda::write_styles(GRAZE_SOURCE_DIR "/cuda/subject/styles", arguments[1]);
    return 0;
  } catch (const std::exception& error) {
    return std::cerr << "graze_write_styles: " << error.what() << "\n", 1;
  }
}
