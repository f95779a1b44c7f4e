// SPDX-License-Identifier: Apache-2.0
// The only file that includes MPI. The shared counter is in the root's memory. Ranks fetch and increment it with
// one-sided operations, so that a slow rank does not delay the others.
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

#include "fuzz/ranks/ranks.h"

namespace graze::fuzz {
namespace {

constexpr int kTag = 1, kTagOfNothing = 2;
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;  // because MPI counts bytes in an int

void check(int code, const char* what) {
  if (code != MPI_SUCCESS) {
    char text[MPI_MAX_ERROR_STRING];
    int length = 0;
    MPI_Error_string(code, text, &length);
    throw std::runtime_error(std::string(what) + " failed: " + std::string(text, static_cast<std::size_t>(length)));
  }
}

class MpiRanks final : public Ranks {
 public:
  MpiRanks() {
    int threads = MPI_THREAD_SINGLE;
    check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_MULTIPLE, &threads), "MPI_Init_thread");
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    MPI_Comm local;
    check(MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank, MPI_INFO_NULL, &local),
          "MPI_Comm_split_type");
    MPI_Comm_rank(local, &local_rank);
    MPI_Comm_size(local, &local_size);
    MPI_Comm_free(&local);
    const MPI_Aint bytes = rank == 0 ? sizeof(std::uint64_t) : 0;
    check(MPI_Win_allocate(bytes, sizeof(std::uint64_t), MPI_INFO_NULL, MPI_COMM_WORLD, &counter_, &window_),
          "MPI_Win_allocate");
    if (rank == 0) *counter_ = 0;
    MPI_Barrier(MPI_COMM_WORLD);
    check(MPI_Win_lock_all(MPI_MODE_NOCHECK, window_), "MPI_Win_lock_all");
    // On some networks the counter responds only while the root is inside an MPI call. So a thread of the root polls
    // MPI while the root computes.
    if (rank == 0 && local_size < size && threads == MPI_THREAD_MULTIPLE) {
      progress_ = std::jthread([](const std::stop_token& stop) {
        for (int found = 0; !stop.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(1)))
          MPI_Iprobe(MPI_ANY_SOURCE, kTagOfNothing, MPI_COMM_WORLD, &found, MPI_STATUS_IGNORE);
      });
    }
  }

  ~MpiRanks() override {
    progress_ = {};
    MPI_Win_unlock_all(window_);
    MPI_Win_free(&window_);
    MPI_Finalize();
  }

  std::string from_root(const std::string& text) override {
    std::uint64_t length = text.size();
    MPI_Bcast(&length, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    std::string all = rank == 0 ? text : std::string(length, '\0');
    for (std::size_t at = 0; at < length; at += kMostAtOnce)
      MPI_Bcast(all.data() + at, static_cast<int>(std::min<std::size_t>(kMostAtOnce, length - at)), MPI_BYTE, 0,
                MPI_COMM_WORLD);
    return all;
  }

  std::uint64_t next() override {
    const std::uint64_t one = 1;
    std::uint64_t before = 0;
    check(MPI_Fetch_and_op(&one, &before, MPI_UINT64_T, 0, 0, MPI_SUM, window_), "MPI_Fetch_and_op");
    check(MPI_Win_flush(0, window_), "MPI_Win_flush");
    return before;
  }

  void reduce(const std::function<std::string()>& give, const std::function<void(const std::string&)>& take) override {
    for (int step = 1; step < size; step *= 2) {
      if (rank % (2 * step) != 0) {
        send(give(), rank - step);
        return;
      }
      if (rank + step < size) take(receive(rank + step));
    }
  }

  bool all(bool here) override {
    int mine = here ? 1 : 0, least = 0;
    MPI_Allreduce(&mine, &least, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    return least == 1;
  }

  void abort(int status) override { MPI_Abort(MPI_COMM_WORLD, status); }

 private:
  static void send(const std::string& bytes, int to) {
    const std::uint64_t length = bytes.size();
    MPI_Send(&length, 1, MPI_UINT64_T, to, kTag, MPI_COMM_WORLD);
    for (std::size_t at = 0; at < length; at += kMostAtOnce)
      MPI_Send(bytes.data() + at, static_cast<int>(std::min<std::size_t>(kMostAtOnce, length - at)), MPI_BYTE, to, kTag,
               MPI_COMM_WORLD);
  }

  static std::string receive(int from) {
    std::uint64_t length = 0;
    MPI_Recv(&length, 1, MPI_UINT64_T, from, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    std::string bytes(length, '\0');
    for (std::size_t at = 0; at < length; at += kMostAtOnce)
      MPI_Recv(bytes.data() + at, static_cast<int>(std::min<std::size_t>(kMostAtOnce, length - at)), MPI_BYTE, from,
               kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return bytes;
  }

  std::uint64_t* counter_ = nullptr;
  MPI_Win window_ = MPI_WIN_NULL;
  std::jthread progress_;
};

}  // namespace

extern "C" Ranks* graze_open_ranks() { return new MpiRanks; }

}  // namespace graze::fuzz
