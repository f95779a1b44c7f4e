// SPDX-License-Identifier: Apache-2.0
#include "subjects/sealed_copy.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace graze::subjects {

SealedCopy::SealedCopy(const std::string& name, std::string_view bytes)
    : fd_(memfd_create(name.substr(0, 200).c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
  ssize_t count = 0;
  while (fd_ >= 0 && !bytes.empty() && ((count = write(fd_, bytes.data(), bytes.size())) > 0 || errno == EINTR))
    bytes.remove_prefix(count > 0 ? static_cast<std::size_t>(count) : 0);
  if (fd_ >= 0 && bytes.empty() &&
      fcntl(fd_, F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0)
    return;
  const int why = errno;
  if (fd_ >= 0) close(fd_);
  throw std::system_error(why, std::generic_category(), "cannot share memory with a subject for its code, " + name);
}

SealedCopy::~SealedCopy() { close(fd_); }

}  // namespace graze::subjects
