// SPDX-License-Identifier: MIT
// cpp-httplib reads requests in threads of its own; each hands its work to the worker and encodes the result, so that
// one frame is encoded and sent while the next one is made.
#include "server.hpp"

#include <fmt/core.h>
#include <httplib.h>

#include <limits>
#include <mutex>

#include "../pictures.hpp"
#include "../terminal.hpp"
#include "encoded.hpp"
#include "facts.hpp"
#include "guard.hpp"

namespace gnomon::app {
namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::ordered_json;

constexpr std::size_t connections = 48;  // that are answered at once, each by a thread
constexpr int patience_s = 5;            // with a client that neither reads nor writes
constexpr std::size_t longest_client_name = 32;

std::string json_text(const ordered_json& json) {
    return json.dump(-1, ' ', true, ordered_json::error_handler_t::replace);
}

/// The address to which a browser of this machine connects.
std::string address_of(const std::string& host) {
    if (host == "0.0.0.0") return "127.0.0.1";
    if (host == "::") return "[::1]";
    return host.find(':') != std::string::npos ? "[" + host + "]" : host;
}

/// An error is one sentence, with the status of its kind.
void answer_error(Response& response, int status, const char* sentence) {
    response.status = status;
    response.set_content(sentence, "text/plain; charset=utf-8");
}

/// Answers by `handler`; a failure is its sentence and a status.
template <typename Handler>
void answer(Response& response, const Handler& handler) {
    try {
        handler();
    } catch (const UsageError& error) {
        answer_error(response, 400, error.what());
    } catch (const InvalidArgument& error) {
        answer_error(response, 400, error.what());
    } catch (const Superseded& error) {
        answer_error(response, 409, error.what());
    } catch (const Busy& error) {
        answer_error(response, 503, error.what());
    } catch (const std::bad_alloc&) {
        answer_error(response, 500, "this machine has too little memory for the picture");
    } catch (const std::exception& error) {
        answer_error(response, 500, error.what());
    }
}

void set_security_headers(Response& response) {
    response.set_header("Content-Security-Policy",
                        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
                        "connect-src 'self'; base-uri 'none'; form-action 'none'");
    response.set_header("Referrer-Policy", "no-referrer");
    response.set_header("X-Content-Type-Options", "nosniff");
    response.set_header("Cross-Origin-Resource-Policy", "same-origin");
    response.set_header("Cache-Control", "no-store");
}

}  // namespace

struct PageServer::Inside {
    Inside(const PageOptions& of, Worker& by) : page(of), worker(by) {}

    PageOptions page;
    Worker& worker;
    std::string token = random_token();
    httplib::Server http{};
    std::function<void()> at_first_page{};
    std::once_flag first_page{};

    /// Sends no answer but an error to who may not ask.
    bool refuses(const Request& request, Response& response) const {
        set_security_headers(response);
        const std::string host = request.get_header_value("Host");
        const std::string token_header = request.get_header_value("X-Gnomon-Token");
        const std::string given = token_header.empty() ? request.get_param_value("token") : token_header;
        const char* reason = nullptr;
        if (request.get_header_value_count("Host") != 1 || !is_own_host(host, page.host))
            reason = "the header Host names another server";
        else if (!is_own_origin(request.get_header_value("Origin"), host))
            reason = "another page sent this request";
        else if (request.method != "GET" || request.has_header("Range") || request.has_header("Content-Length") ||
                 request.has_header("Transfer-Encoding"))
            reason = "only whole answers to GET are sent";
        else if (!equals_in_constant_time(given, token))
            reason = "the token is missing or wrong: open the address that gnomon view printed";
        if (reason != nullptr) answer_error(response, 403, reason);
        return reason != nullptr;
    }

    /// Who asks, for `what`: its newer requests supersede its older ones.
    static std::string client_of(const Request& request, const char* what) {
        std::string client = request.get_header_value("X-Gnomon-Client");
        if (client.size() > longest_client_name) throw UsageError("the client's name is too long");
        return client + "/" + what;
    }

    Frame picture(const Request& request) {
        const RenderOptions options = render_request(page, {request.params.begin(), request.params.end()});
        Frame frame = worker.run(client_of(request, "picture"), [&](ViewSession& session, const GoOn& go_on) {
            return session.picture(options, go_on);
        });
        set_command(request, frame);
        return frame;
    }
    Frame comparison(const Request& request) {
        const RenderOptions options = render_request(page, {request.params.begin(), request.params.end()});
        Frame frame = worker.run(client_of(request, "picture"),
                                 [&](ViewSession& session, const GoOn&) { return session.comparison(options); });
        set_command(request, frame);
        return frame;
    }
    Frame hours(const Request& request, bool has_legend) {
        const Parameters parameters(request.params.begin(), request.params.end());
        const HoursOptions options = hours_request(page, parameters);
        Frame frame = worker.run(client_of(request, "picture"), [&](ViewSession& session, const GoOn& go_on) {
            return session.hours(options, has_legend, go_on);
        });
        frame.facts["command"] = shell_line(hours_arguments(page, parameters));
        return frame;
    }
    void set_command(const Request& request, Frame& frame) const {
        frame.facts["command"] = shell_line(render_arguments(page, {request.params.begin(), request.params.end()}));
    }
    void send_jpeg(const Request& request, Response& response, Frame frame) const {
        const auto start = std::chrono::steady_clock::now();
        const std::string jpeg = jpeg_of(frame, request.has_param("draft"));
        frame.facts["ms"]["jpeg"] =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        response.set_header("X-Gnomon", json_text(frame.facts));
        response.set_content(jpeg, "image/jpeg");
    }
    void send_png(const Frame& frame, Response& response) const {
        response.set_header("X-Gnomon", json_text(frame.facts));
        response.set_content(png_of(frame.width, frame.height, frame.rgba), "image/png");
    }
    void send_explanation(const Request& request, Response& response) {
        const Parameters parameters(request.params.begin(), request.params.end());
        const ExplainOptions options = explain_request(page, parameters);
        ordered_json explanation =
            worker.run(client_of(request, "explanation"),
                       [&](ViewSession& session, const GoOn&) { return session.explanation(options); });
        explanation["command"] = shell_line(explain_arguments(page, parameters));
        response.set_content(json_text(explanation), "application/json");
    }
    void send_page(Response& response) {
        if (at_first_page) std::call_once(first_page, at_first_page);
        std::string html(text_file("view/page.html"));
        constexpr std::string_view slot = "{{token}}";
        for (std::size_t at = 0; (at = html.find(slot, at)) != std::string::npos;) html.replace(at, slot.size(), token);
        response.set_content(html, "text/html; charset=utf-8");
    }

    /// Answers a path by `handler`.
    template <typename Handler>
    void route(const char* path, const Handler& handler) {
        http.Get(path, [handler](const Request& request, Response& response) {
            answer(response, [&] { handler(request, response); });
        });
    }
    void set_up() {
        http.new_task_queue = [] { return new httplib::ThreadPool(connections); };
        http.set_keep_alive_max_count(std::numeric_limits<std::size_t>::max());
        http.set_keep_alive_timeout(patience_s).set_read_timeout(patience_s).set_write_timeout(patience_s);
        http.set_payload_max_length(0).set_tcp_nodelay(true);
        // Not the port of another server: cpp-httplib would share it (SO_REUSEPORT).
        http.set_socket_options([](socket_t socket) {
            const int yes = 1;
            setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        });
        http.set_pre_routing_handler([this](const Request& request, Response& response) {
            return refuses(request, response) ? httplib::Server::HandlerResponse::Handled
                                              : httplib::Server::HandlerResponse::Unhandled;
        });
        route("/", [this](const Request&, Response& response) { send_page(response); });
        for (const char* const path : {"/page.css", "/geometry.js", "/pictures.js", "/panel.js", "/controls.js"})
            route(path, [path](const Request&, Response& response) {
                const bool is_style = std::string_view(path).ends_with(".css");
                response.set_content(std::string(text_file(std::string("view") + path)),
                                     is_style ? "text/css; charset=utf-8" : "text/javascript; charset=utf-8");
            });
        route("/state", [this](const Request&, Response& response) {
            response.set_content(json_text(worker.state()), "application/json");
        });
        route("/frame.jpg",
              [this](const Request& request, Response& response) { send_jpeg(request, response, picture(request)); });
        route("/frame.png",
              [this](const Request& request, Response& response) { send_png(picture(request), response); });
        route("/compare.jpg", [this](const Request& request, Response& response) {
            send_jpeg(request, response, comparison(request));
        });
        route("/compare.png",
              [this](const Request& request, Response& response) { send_png(comparison(request), response); });
        route("/hours.jpg", [this](const Request& request, Response& response) {
            send_jpeg(request, response, hours(request, false));
        });
        route("/hours.png",
              [this](const Request& request, Response& response) { send_png(hours(request, true), response); });
        route("/explain", [this](const Request& request, Response& response) { send_explanation(request, response); });
        route("/suns", [](const Request& request, Response& response) {
            const SunsOfPlace place = suns_request({request.params.begin(), request.params.end()});
            response.set_content(json_text(suns_facts(suns_of_place(place, 0))), "application/json");
        });
    }
};

PageServer::PageServer(const PageOptions& page, Worker& worker) : inside_(std::make_unique<Inside>(page, worker)) {
    inside_->set_up();
    const int port = page.port != 0 ? (inside_->http.bind_to_port(page.host, int(page.port)) ? int(page.port) : -1)
                                    : inside_->http.bind_to_any_port(page.host);
    if (port <= 0)
        throw Error(page.port != 0
                        ? fmt::format("cannot listen at {}, port {}: does another program?", page.host, page.port)
                        : "cannot listen at " + page.host + ": is it an address of this machine?");
    port_ = std::uint32_t(port);
}

PageServer::~PageServer() = default;

std::string PageServer::address() const {
    return fmt::format("http://{}:{}/?token={}", address_of(inside_->page.host), port_, inside_->token);
}

void PageServer::serve(std::function<void()> at_first_page) {
    inside_->at_first_page = std::move(at_first_page);
    if (!inside_->http.listen_after_bind()) throw Error("the server's socket is closed");
}

}  // namespace gnomon::app
