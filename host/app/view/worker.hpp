// SPDX-License-Identifier: MIT
// The thread that owns the device. Each client has one place in its queue: a newer request takes the place of one that
// waits, and ends one that runs long, so that a client gets what it asked for last and waits for no other's past.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include "session.hpp"

namespace gnomon::app {

/// A newer request of the same client is there.
class Superseded : public std::runtime_error {
public:
    Superseded() : std::runtime_error("a newer request took its place") {}
};

/// Too many clients wait.
class Busy : public std::runtime_error {
public:
    Busy() : std::runtime_error("too many clients wait") {}
};

class Worker {
public:
    explicit Worker(const PageOptions& page);
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    /// What is being done while the scene is read, or why it cannot be shown, else the session's facts. Waits for no
    /// work.
    nlohmann::ordered_json state() const;

    /// Runs `work` on the device and waits for its result. `client` names who asks, and for what. Throws Superseded,
    /// Busy, or what `work` throws.
    template <typename Work>
    auto run(const std::string& client, const Work& work) {
        using Result = std::invoke_result_t<const Work&, ViewSession&, const GoOn&>;
        auto promise = std::make_shared<std::promise<Result>>();
        submit(client, {[promise, work](ViewSession& session, const GoOn& go_on) {
                            try {
                                promise->set_value(work(session, go_on));
                            } catch (const Cancelled&) {
                                promise->set_exception(std::make_exception_ptr(Superseded()));
                            } catch (...) {
                                promise->set_exception(std::current_exception());
                            }
                        },
                        [promise](std::exception_ptr error) { promise->set_exception(std::move(error)); }});
        return promise->get_future().get();
    }

private:
    struct Job {
        std::function<void(ViewSession&, const GoOn&)> run;
        std::function<void(std::exception_ptr)> fail;
        std::string client{};
    };
    static constexpr std::size_t most_waiting = 32;

    void submit(const std::string& client, Job job);
    bool is_newest(const std::string& client) const;
    void work(const PageOptions& page, const std::stop_token& stop);
    std::optional<Job> next(const std::stop_token& stop);

    mutable std::mutex mutex_;
    std::condition_variable_any wake_;
    std::deque<Job> waiting_;  ///< at most one of each client
    nlohmann::ordered_json state_;
    std::optional<std::string> failure_;
    std::jthread thread_;  ///< last: the thread uses the other members
};

}  // namespace gnomon::app
