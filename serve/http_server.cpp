// The only source that sees cpp-httplib. A library of its own, which serve_http() loads: Debian's cpp-httplib
// brings OpenSSL and Brotli along, and 2 ms to each start of a program that is linked with it.
#include <httplib.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>

#include "serve/http.hpp"

namespace twinchute::serve {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr std::size_t threads = 8;
constexpr auto patience = 5s;  // with a request that does not arrive, and with a reader that does not read
constexpr auto between_requests = 5s;            // that a connection without any is kept
constexpr std::size_t largest_head = 64u << 10;  // [bytes] request line and headers

/// A connection that ends when the server does. The library's own waits for its time-outs.
class Connection final : public httplib::Stream {
public:
    Connection(int handle, int stop) : handle_(handle), stop_(stop) {}
    ~Connection() override {
        ::shutdown(handle_, SHUT_WR);
        // Bytes that nobody read would make the system take back an answer that is still on its way.
        deadline_ = Clock::now() + (refused ? 200ms : 0ms);
        for (std::size_t dropped = 0; dropped <= largest_body && fill();)
            dropped += buffered_;
        ::close(handle_);
    }

    /// Waits for the first byte of a request.
    bool next_request() {
        refused.reset();
        request = {};
        deadline_ = Clock::now() + between_requests;
        if (at_ == buffered_ && !fill()) return false;
        deadline_ = Clock::now() + patience;
        left_ = largest_head + largest_body;
        return true;
    }

    bool is_readable() const override { return at_ < buffered_ || wait(POLLIN, deadline_); }
    bool is_writable() const override { return wait(POLLOUT, Clock::now() + patience); }
    ssize_t read(char* to, std::size_t size) override {
        if (at_ == buffered_ && !fill()) return -1;
        const std::size_t count = std::min({size, buffered_ - at_, left_});
        if (count == 0) return -1;  // more than any request that would be answered
        std::memcpy(to, buffer_.data() + at_, count);
        at_ += count;
        left_ -= count;
        return static_cast<ssize_t>(count);
    }
    ssize_t write(const char* from, std::size_t size) override {
        return is_writable() ? ::send(handle_, from, size, MSG_NOSIGNAL) : -1;
    }
    void get_remote_ip_and_port(std::string&, int&) const override {}
    void get_local_ip_and_port(std::string&, int&) const override {}
    socket_t socket() const override { return handle_; }

    HttpRequest request;  ///< the one that is being answered
    std::optional<HttpAnswer> refused;

private:
    bool wait(short events, Clock::time_point until) const {
        for (;;) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
            if (left <= 0) return false;
            std::array<pollfd, 2> both{{{handle_, events, 0}, {stop_, POLLIN, 0}}};
            const int ready = ::poll(both.data(), both.size(), static_cast<int>(left));
            if (ready < 0 && errno == EINTR) continue;
            return ready > 0 && both[1].revents == 0 && both[0].revents != 0;
        }
    }
    bool fill() {
        if (!wait(POLLIN, deadline_)) return false;
        const ssize_t got = ::recv(handle_, buffer_.data(), buffer_.size(), 0);
        at_ = 0;
        buffered_ = got > 0 ? static_cast<std::size_t>(got) : 0;
        return got > 0;
    }

    int handle_, stop_;
    Clock::time_point deadline_;
    std::size_t left_ = 0;  // [bytes] that this request may still have
    std::array<char, 4096> buffer_;
    std::size_t at_ = 0, buffered_ = 0;
};

thread_local Connection* current = nullptr;  // its thread serves one at a time

std::string small(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

HttpRequest without_body(const httplib::Request& from) {
    HttpRequest request{from.method, from.path, {}, {}, {}};
    request.query.insert(from.params.begin(), from.params.end());
    for (const auto& [name, value] : from.headers)
        request.headers.emplace(small(name), value);
    return request;
}

void put(const HttpAnswer& from, httplib::Response& to) {
    to.status = from.status;
    to.set_content(from.body, from.type);
    for (const auto& [name, value] : from.headers)
        to.set_header(name, value);
}

class Server final : public httplib::Server {
public:
    explicit Server(const HttpService& service) : service_(service), stop_(::eventfd(0, EFD_CLOEXEC)) {
        new_task_queue = [this] { return new Pool(*this); };
        set_idle_interval(0, 100'000);
        set_payload_max_length(largest_body);
        // Not the library's own, by which another process may listen on the same port.
        set_socket_options([](socket_t handle) {
            const int yes = 1;
            ::setsockopt(handle, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        });
        set_tcp_nodelay(true);
        set_default_headers({service.headers.begin(), service.headers.end()});
        set_pre_routing_handler([this](const httplib::Request&, httplib::Response& response) {
            Connection& connection = *current;
            if (!connection.refused && connection.request.method == "POST")
                return HandlerResponse::Unhandled;  // once its body is there
            put(connection.refused ? *connection.refused : service_.answer(connection.request), response);
            return HandlerResponse::Handled;
        });
        Post(".*", [this](const httplib::Request& request, httplib::Response& response) {
            current->request.body = request.body;
            put(service_.answer(current->request), response);
        });
        // Complaints of the library itself.
        set_error_handler([](const httplib::Request&, httplib::Response& response) {
            if (response.body.empty())
                response.set_content(R"({"error": {"message": "the request cannot be read"}})",
                                     "application/json");
        });
        set_exception_handler([](const httplib::Request&, httplib::Response& response, std::exception_ptr) {
            response.status = 500;
            response.set_content(R"({"error": {"message": "the answer failed"}})", "application/json");
        });
    }
    ~Server() override { ::close(stop_); }

private:
    /// Its threads are the only ones; between connections it looks whether to stop.
    struct Pool final : httplib::ThreadPool {
        explicit Pool(Server& its) : ThreadPool(threads), server(its) {}
        void on_idle() override {
            if (server.service_.stop.stop_requested()) server.stop();
        }
        void shutdown() override {
            ::eventfd_write(server.stop_, 1);  // every connection ends
            ThreadPool::shutdown();
        }
        Server& server;
    };

    bool process_and_close_socket(socket_t handle) override {
        Connection connection(handle, stop_);
        current = &connection;
        try {
            bool goes_on = true;
            while (goes_on && !service_.stop.stop_requested() && connection.next_request()) {
                bool closed = false, understood = false;
                const bool answered =
                    process_request(connection, false, closed, [&](httplib::Request& request) {
                        // Answers go as they are: whole, and without the time that compression takes.
                        request.ranges.clear();
                        request.headers.erase("Accept-Encoding");
                        connection.request = without_body(request);
                        connection.refused = service_.refuse(connection.request);
                        if (connection.refused) request.headers.erase("Expect");
                        understood = true;
                    });
                // After anything else what follows may be a body that nobody has read.
                goes_on = answered && understood && !closed && !connection.refused;
            }
        } catch (const std::exception&) {
            // Nobody is left to tell: the connection ends.
        }
        current = nullptr;
        return true;
    }

    const HttpService& service_;
    int stop_;  // readable once the server stops
};

}  // namespace
}  // namespace twinchute::serve

/// Returns the complaint of the system where the port cannot be had; empty otherwise, after the end.
extern "C" __attribute__((visibility("default"))) void twinchute_serve_http(
    const twinchute::serve::HttpService& service, std::string& complaint) {
    twinchute::serve::Server server(service);
    const std::string host = "127.0.0.1";
    errno = 0;
    const int port = service.port == 0                         ? server.bind_to_any_port(host)
                     : server.bind_to_port(host, service.port) ? service.port
                                                               : -1;
    if (port < 0) {
        complaint = std::strerror(errno);
        return;
    }
    service.listening(port);
    server.listen_after_bind();
}
