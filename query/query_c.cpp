// SPDX-License-Identifier: Apache-2.0
// The C ABI. A context checks a query, chooses an executor, and answers the query. No exception passes through the ABI.
#include "query/include/graze/query_c.h"

#include <chrono>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/stop.h"
#include "query/collector.h"
#include "query/question.h"

using graze::cuda::DeviceFailure;
using graze::query::Collector;
using graze::query::QueryError;
using graze::query::Question;

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void set(graze_answer& answer, graze_status status, const char* message) {
  answer.status = status;
  std::snprintf(answer.message, sizeof answer.message, "%s", message);
}

}  // namespace

// Defines the type that query_c.h declares.
struct graze_context {
 public:
  // Always fills in the answer, whose status tells whether the query failed.
  void run(const graze_query& query, graze_answer& answer) noexcept;

 private:
  struct Device {
    std::mutex turn;
    std::unique_ptr<graze::cuda::QueryDevice> open;  // null before the first use and after a failure
  };
  void answer(const graze_query& query, graze_answer& answer);
  Device& device(int number);

  std::mutex mutex_;
  std::map<int, Device> devices_;
};

graze_context::Device& graze_context::device(int number) {
  const std::lock_guard lock(mutex_);
  return devices_[number];
}

void graze_context::answer(const graze_query& query, graze_answer& answer) {
  const Question question = graze::query::question_of(query);
  answer.triangles = question.triangles;
  answer.executor = question.executor;
  const graze::query::Outputs outputs =
      query.outputs_on_device ? graze::query::Outputs{}
                              : graze::query::Outputs{query.bytes, query.bits, query.list, query.list_room};
  graze::query::Progress progress;
  if (query.progress)
    progress = [&](std::uint64_t done) { return query.progress(query.user, done, question.triangles) == 0; };
  Collector collector(question.counts, question.places, query.reference_count, question.any, outputs,
                      std::move(progress));
  std::exception_ptr failed;
  if (question.devices.empty()) {
    try {
      run_on_cpu(question, collector);
    } catch (...) {
      failed = std::current_exception();
    }
  } else {
    std::mutex mutex;
    const auto run = [&](int number) noexcept {
      std::exception_ptr wrong;
      graze::cuda::LaunchRecord record;
      try {
        Device& device = this->device(number);
        const std::lock_guard turn(device.turn);
        try {
          if (!device.open) device.open = graze::cuda::open_query_device(number);
          record = device.open->run(question, collector);
        } catch (...) {
          device.open.reset();  // the next query opens it again
          throw;
        }
      } catch (...) {
        wrong = std::current_exception();
      }
      if (wrong) collector.stop();
      const std::lock_guard lock(mutex);
      if (wrong && !failed) failed = wrong;
      if (record.longest > answer.longest_launch) answer.longest_launch = record.longest;
    };
    std::vector<std::jthread> others;
    try {
      for (std::size_t d = 1; d < question.devices.size(); ++d) others.emplace_back(run, question.devices[d]);
    } catch (...) {
      collector.stop();
      failed = std::current_exception();
    }
    run(question.devices[0]);
    others.clear();
  }
  const Collector::Found found = collector.found();
  answer.position = found.position;
  answer.hits = found.hits;
  answer.declined = found.declined;
  answer.first = found.first;
  answer.first_reference = found.reference;
  if (failed) std::rethrow_exception(failed);
  if (found.cancelled) throw QueryError(GRAZE_CANCELLED, "cancelled by the progress callback");
  if (found.position != question.triangles && !(question.any && found.hits != 0))
    throw QueryError(GRAZE_FAILED, "some triangles were not answered: this is a bug in graze");
}

void graze_context::run(const graze_query& query, graze_answer& result) noexcept {
  const double start = now();
  result = {};
  result.first = ~std::uint64_t{0};
  try {
    answer(query, result);
  } catch (const QueryError& error) {
    set(result, error.status, error.what());
  } catch (const DeviceFailure& error) {
    set(result, error.out_of_memory ? GRAZE_NO_MEMORY : GRAZE_DEVICE_FAILED, error.what());
  } catch (const graze::Stopped&) {
    set(result, GRAZE_CANCELLED, "interrupted while a subject was running");
  } catch (const std::bad_alloc&) {
    set(result, GRAZE_NO_MEMORY, "there is not enough memory for the query");
  } catch (const std::exception& error) {
    set(result, GRAZE_FAILED, error.what());
  } catch (...) {
    set(result, GRAZE_FAILED, "the progress callback threw an exception of an unknown type");
  }
  result.seconds = now() - start;
}

extern "C" {

graze_context* graze_open(void) { return new (std::nothrow) graze_context; }

void graze_close(graze_context* context) { delete context; }

int graze_devices(void) {
  try {
    std::string why_not;
    return graze::cuda::count_query_devices(why_not);
  } catch (...) {
    return 0;
  }
}

int graze_run(graze_context* context, const graze_query* query, graze_answer* answer) {
  if (!answer) return GRAZE_BAD_ARGUMENT;
  if (context && query) {
    context->run(*query, *answer);
    return answer->status;
  }
  *answer = {};
  answer->first = UINT64_MAX;
  set(*answer, GRAZE_BAD_ARGUMENT,
      context ? "query: expected a pointer, found NULL" : "context: expected a pointer, found NULL");
  return answer->status;
}
}
