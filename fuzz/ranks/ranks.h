// SPDX-License-Identifier: Apache-2.0
// The processes that `mpirun` started together, as the rest of Graze sees them. Only mpi.cpp sees MPI: it is a library
// of its own beside the program, opened when mpirun started it, so that without MPI nothing changes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace graze::fuzz {

class Ranks {
 public:
  virtual ~Ranks() = default;  // all of them must come here, or none

  int rank = 0, size = 1;
  int local_rank = 0, local_size = 1;  // among those on this host

  // The root's text, for all.
  virtual std::string from_root(const std::string& text) = 0;

  // Takes the next number of a counter that all share; it waits for no other rank.
  virtual std::uint64_t next() = 0;

  // Everything that the rank and those behind it in the tree know goes to the one before it, in log2(size) rounds.
  // Each round either sends what `give` returns, and is done, or hands what it received to `take`.
  struct Reduction {
    virtual ~Reduction() = default;
    virtual std::string give() = 0;
    virtual void take(const std::string& bytes) = 0;
  };
  virtual void reduce(Reduction& reduction) = 0;

  // Whether it is so on every rank.
  virtual bool all(bool here) = 0;

  // Ends all ranks at once: one that has failed must not leave the others waiting.
  virtual void abort(int status) = 0;
};

// Whether mpirun, or Slurm's srun, started this process, with others.
bool started_by_mpirun();

// The ranks; MPI is begun.   Requires: started_by_mpirun().
// Throws: std::runtime_error where this build, or this machine, is without MPI.
std::unique_ptr<Ranks> open_ranks();

// Leaves this process one CUDA device, by its number on this host.   Requires: CUDA has not begun.
void take_one_device(int local_rank);

}  // namespace graze::fuzz
