// SPDX-License-Identifier: MIT
// The page's server: who may ask, for what, and in which words the answer comes.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "worker.hpp"

namespace gnomon::app {

class PageServer {
public:
    /// Listens at the options' address from here on. Throws Error.
    PageServer(const PageOptions& page, Worker& worker);
    ~PageServer();

    /// "http://127.0.0.1:8000/?token=..."
    std::string address() const;
    std::uint32_t port() const { return port_; }
    /// Answers until the program ends. `at_first_page` is called when the page is sent for the first time.
    void serve(std::function<void()> at_first_page);

private:
    struct Inside;
    std::unique_ptr<Inside> inside_;
    std::uint32_t port_ = 0;
};

}  // namespace gnomon::app
