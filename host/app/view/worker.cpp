// SPDX-License-Identifier: MIT
#include "worker.hpp"

#include <algorithm>

#include "../terminal.hpp"

namespace gnomon::app {

Worker::Worker(const PageOptions& page)
    : state_{{"doing", "starting"}}, thread_([this, page](const std::stop_token& stop) { work(page, stop); }) {}

Worker::~Worker() = default;

nlohmann::ordered_json Worker::state() const {
    const std::scoped_lock lock(mutex_);
    return state_;
}

void Worker::submit(const std::string& client, Job job) {
    job.client = client;
    const std::scoped_lock lock(mutex_);
    if (failure_) throw Error(*failure_);
    const auto same = std::ranges::find_if(waiting_, [&](const Job& other) { return other.client == client; });
    if (same != waiting_.end()) {
        same->fail(std::make_exception_ptr(Superseded()));
        *same = std::move(job);
    } else {
        if (waiting_.size() >= most_waiting) throw Busy();
        waiting_.push_back(std::move(job));
    }
    wake_.notify_one();
}

bool Worker::is_newest(const std::string& client) const {
    const std::scoped_lock lock(mutex_);
    return std::ranges::none_of(waiting_, [&](const Job& other) { return other.client == client; });
}

std::optional<Worker::Job> Worker::next(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    if (!wake_.wait(lock, stop, [this] { return !waiting_.empty(); })) return {};
    Job job = std::move(waiting_.front());
    waiting_.pop_front();
    return job;
}

void Worker::work(const PageOptions& page, const std::stop_token& stop) {
    const auto tell = [this](nlohmann::ordered_json state) {
        const std::scoped_lock lock(mutex_);
        state_ = std::move(state);
    };
    try {
        ViewSession session(page, [&](const std::string& what) { tell({{"doing", what}}); });
        tell(session.facts());
        while (const std::optional<Job> job = next(stop)) job->run(session, [&] { return is_newest(job->client); });
    } catch (const std::exception& error) {
        print_error(error.what());
        tell({{"failure", error.what()}});
        const std::scoped_lock lock(mutex_);
        failure_ = error.what();
        for (const Job& job : waiting_) job.fail(std::make_exception_ptr(Error(*failure_)));
        waiting_.clear();
    }
}

}  // namespace gnomon::app
