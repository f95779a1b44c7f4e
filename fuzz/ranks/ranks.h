// SPDX-License-Identifier: Apache-2.0
// The interface to the processes that `mpirun` started together. Only mpi.cpp includes MPI, and becomes a separate
// library that is loaded only under mpirun, so the program also runs without MPI.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace graze::fuzz {

class Ranks {
 public:
  virtual ~Ranks() = default;  // collective: all ranks must call it

  int rank = 0, size = 1;
  int local_rank = 0, local_size = 1;  // among the ranks on this host

  // Broadcasts the root's text to all ranks.
  virtual std::string from_root(const std::string& text) = 0;

  // Takes the next number from the counter that all ranks share, without waiting for other ranks.
  virtual std::uint64_t next() = 0;

  // Combines all ranks' data on the root, along a tree, in log2(size) rounds. In each round a rank either sends the
  // result of `give` to its parent and is done, or passes the bytes that it received to `take`.
  virtual void reduce(const std::function<std::string()>& give,
                      const std::function<void(const std::string& bytes)>& take) = 0;

  // Returns whether `here` is true on every rank.
  virtual bool all(bool here) = 0;

  // Ends all ranks at once, so that a failed rank does not leave the others waiting.
  virtual void abort(int status) = 0;
};

// Whether mpirun, or Slurm's srun, started this process together with others.
bool started_by_mpirun();

// Initialises MPI and returns the ranks.   Requires: started_by_mpirun().
// Throws: std::runtime_error if this build or this machine has no MPI.
std::unique_ptr<Ranks> open_ranks();

// Restricts this process to one CUDA device, chosen by its local rank.   Requires: CUDA is not initialised yet.
void take_one_device(int local_rank);

}  // namespace graze::fuzz
