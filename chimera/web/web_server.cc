// SPDX-License-Identifier: Apache-2.0
// Accepts browsers, answers their requests as the gate judges, and copies lines between WebSockets and sockets.
#include "chimera/web/web_server.h"

#include <utility>  // before asio, which lacks it

#include <boost/asio.hpp>
#include <boost/beast/core/flat_static_buffer.hpp>
#include <boost/beast/websocket.hpp>

#include <algorithm>
#include <climits>
#include <vector>

#include "chimera/control/closings.h"
#include "chimera/platform/local_socket.h"
#include "chimera/web/bench_server.h"
#include "chimera/web/gate.h"
#include "chimera/web/limits.h"
#include "chimera/web/page_key.h"

namespace chimera::web {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using LocalSocket = asio::local::stream_protocol::socket;
using Code = boost::system::error_code;

Nanoseconds now() { return LinuxClock().now(); }

}  // namespace

/// The acceptor, the server of the bench and all connections. Context: setup.
class WebServer::Loop {
 public:
  Loop(PageContents page, PageKey key, BenchFacts facts, const Tell& tell);
  ~Loop();

  Result<void> open(std::optional<std::uint16_t> port);
  void run();
  const std::string& link() const noexcept { return link_; }

  const PageContents& page() const noexcept { return page_; }
  const PageKey& key() const noexcept { return key_; }
  /// Another connection showed the key: has it a place? "": yes, else why not.
  std::string admit(bool is_bench);
  /// A connected socket to the server that the verdict names; none, with the reason for the browser.
  std::optional<LocalSocket> door_to(const GateVerdict& verdict, websocket::close_reason& why);
  void refuse(const std::string& sentence) { refusals_.add(0, sentence, now()); }
  void machine_ended() { bench_.bench().look_again(); }
  void leave(const std::shared_ptr<Connection>& connection);

 private:
  std::vector<std::shared_ptr<Connection>> strangers() const;
  bool has_room() const;
  void accept();
  void enter(tcp::socket socket);
  void sweep();
  void wait_for_bench();
  void serve_bench();
  void end();

  asio::io_context io_{1};
  PageContents page_;
  PageKey key_;
  BenchServer bench_;
  control::Closings refusals_;
  tcp::acceptor acceptor_{io_};
  asio::signal_set signals_{io_};
  asio::steady_timer sweep_timer_{io_}, bench_timer_{io_};
  asio::posix::stream_descriptor bench_ready_{io_};
  std::vector<std::shared_ptr<Connection>> all_;
  std::string link_;
  bool is_accepting_ = false, is_sweeping_ = false, is_ending_ = false;
};

/// One connection of a browser: a request, then perhaps a WebSocket that is joined to a server.
class WebServer::Connection : public std::enable_shared_from_this<WebServer::Connection> {
 public:
  Connection(Loop& loop, tcp::socket socket) : loop_(loop), socket_(std::move(socket)) {}

  void read_head();
  /// Ends the connection if a time limit has passed.
  void check(Nanoseconds at);
  /// Sends the reason if the browser can take it.
  void close(std::uint16_t code, std::string_view reason);
  void drop();
  bool is_stranger() const noexcept { return !has_key_; }
  bool is_page() const noexcept { return has_key_ && verdict_.kind == GateVerdict::Kind::kBench; }
  Nanoseconds since() const noexcept { return since_; }

 private:
  enum class Stage : unsigned char { kHead, kAnswer, kHandshake, kKey, kOpen, kClosing, kGone };

  /// A handler that keeps the connection until it runs, and is skipped after the end.
  auto then(void (Connection::*next)(Code, std::size_t)) {
    return [self = shared_from_this(), next](Code error, std::size_t n = 0) {
      if (self->stage_ != Stage::kGone) ((*self).*next)(error, n);
    };
  }
  tcp::socket& tcp_socket() { return socket_.next_layer(); }
  void enter(Stage stage, Nanoseconds limit) {
    stage_ = stage;
    due_ = now() + limit;
  }
  void take_head(Code error, std::size_t n);
  void refuse(int status, const std::string& sentence);
  void send_answer(std::string text);
  void drain(Code error, std::size_t n);
  void upgrade();
  void read_key(Code error, std::size_t n);
  void take_key(Code error, std::size_t n);
  void join();
  void read_browser(Code error, std::size_t n);
  void take_from_browser(Code error, std::size_t n);
  void read_door();
  void take_from_door(Code error, std::size_t n);
  void send_next(Code error, std::size_t n);
  void check_open(Nanoseconds at);

  Loop& loop_;
  websocket::stream<tcp::socket, false> socket_;
  std::optional<LocalSocket> door_;
  Stage stage_ = Stage::kHead;
  const Nanoseconds since_ = now();
  Nanoseconds due_ = since_ + kHeadLimit;
  GateVerdict verdict_;
  bool has_key_ = false;
  std::vector<char> in_ = std::vector<char>(kMaxHead);  // the head, later the end of a frame from the browser
  std::vector<char> out_;                               // bytes of the door
  std::size_t in_size_ = 0, out_begin_ = 0, out_end_ = 0;
  std::string answer_;
  boost::beast::flat_static_buffer<kMaxKeyFrame> key_;
  Nanoseconds heard_, pinged_, moved_;  // when the browser was last heard, asked, and took bytes
  int unread_ = INT_MAX;
  bool is_reading_ = false, is_writing_ = false;
};

void WebServer::Connection::read_head() {
  tcp_socket().async_read_some(asio::buffer(in_.data() + in_size_, in_.size() - in_size_),
                               then(&Connection::take_head));
}

void WebServer::Connection::take_head(Code error, std::size_t n) {
  if (error) return drop();
  in_size_ += n;
  verdict_ = judge({in_.data(), in_size_});
  if (verdict_.kind == GateVerdict::Kind::kMore) return read_head();
  if (verdict_.kind == GateVerdict::Kind::kRefused) return refuse(verdict_.status, verdict_.sentence);
  if (verdict_.kind == GateVerdict::Kind::kFile)
    return send_answer(answer(200, kPageFiles[verdict_.file].type, loop_.page()[verdict_.file]));
  if (verdict_.size != in_size_) return refuse(400, "bytes came before the WebSocket was open");
  upgrade();
}

void WebServer::Connection::refuse(int status, const std::string& sentence) {
  loop_.refuse(std::to_string(status) + ": " + sentence);
  send_answer(answer(status, "text/plain; charset=utf-8", sentence + "\n"));
}

void WebServer::Connection::send_answer(std::string text) {
  enter(Stage::kAnswer, kAnswerLimit);
  answer_ = std::move(text);
  asio::async_write(tcp_socket(), asio::buffer(answer_), [self = shared_from_this()](Code error, std::size_t n) {
    if (self->stage_ == Stage::kGone) return;
    if (!error) self->tcp_socket().shutdown(tcp::socket::shutdown_send, error);
    self->enter(Stage::kAnswer, kCloseLimit);
    self->drain(error, n);
  });
}

/// Bytes that nothing reads would make the kernel drop the answer: reads them until the browser closes.
void WebServer::Connection::drain(Code error, std::size_t) {
  if (error) return drop();
  tcp_socket().async_read_some(asio::buffer(in_), then(&Connection::drain));
}

void WebServer::Connection::upgrade() {
  enter(Stage::kHandshake, kKeyLimit);
  socket_.auto_fragment(false);  // else pieces of 4 KiB
  socket_.text(true);
  socket_.read_message_max(kMaxKeyFrame);
  socket_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
    for (const auto& [name, value] : kSafetyFields) response.set(name, value);
  }));
  socket_.control_callback([this](websocket::frame_type, boost::beast::string_view) { heard_ = now(); });
  // Not the bytes of the browser: Beast takes a head of at most 1536 bytes, and the cookies of other ports are longer.
  websocket::request_type request(boost::beast::http::verb::get, "/", 11);
  request.set("Host", "localhost");
  request.set("Connection", "Upgrade");
  request.set("Upgrade", "websocket");
  request.set("Sec-WebSocket-Version", "13");
  request.set("Sec-WebSocket-Key", verdict_.socket_key);
  socket_.async_accept(request, then(&Connection::read_key));
}

void WebServer::Connection::read_key(Code error, std::size_t) {
  if (error) return drop();
  stage_ = Stage::kKey;
  socket_.async_read(key_, then(&Connection::take_key));
}

void WebServer::Connection::take_key(Code error, std::size_t) {
  if (error && error != websocket::error::closed) loop_.refuse("a WebSocket ended without a key: " + error.message());
  if (error) return drop();
  if (stage_ != Stage::kKey) return;
  if (socket_.got_binary()) return close(kNoText, "the key is a text, not a binary frame");
  if (!loop_.key().is({static_cast<const char*>(key_.data().data()), key_.size()})) {
    loop_.refuse("a browser came with another key: its link is old");
    return close(kWrongKey, "the link is old: chimera web was started anew and printed another one");
  }
  join();
}

void WebServer::Connection::join() {
  const std::string full = loop_.admit(verdict_.kind == GateVerdict::Kind::kBench);
  if (!full.empty()) return loop_.refuse(full), close(kFull, full);
  websocket::close_reason why;
  has_key_ = true;
  door_ = loop_.door_to(verdict_, why);
  if (!door_) return close(why.code, {why.reason.data(), why.reason.size()});
  stage_ = Stage::kOpen;
  heard_ = pinged_ = now();
  socket_.read_message_max(control::kMaxLine);
  in_.resize(kChunk + 1);  // one more: the end of a line
  out_.resize(kChunk);
  read_browser({}, 0);
  read_door();
}

void WebServer::Connection::read_browser(Code error, std::size_t) {
  if (error || stage_ != Stage::kOpen) return;  // the reading side of the door learns why
  is_reading_ = true;
  heard_ = now();
  socket_.async_read_some(asio::buffer(in_.data(), kChunk), then(&Connection::take_from_browser));
}

void WebServer::Connection::take_from_browser(Code error, std::size_t n) {
  is_reading_ = false;
  heard_ = now();
  if (error) return drop();
  if (stage_ != Stage::kOpen) return;
  if (socket_.got_binary()) return close(kNoText, "a line is a text, not a binary frame");
  if (std::string_view(in_.data(), n).find('\n') != std::string_view::npos)
    return close(kNoLine, "a frame is one line without its end");
  if (socket_.is_message_done()) in_[n++] = '\n';
  asio::async_write(*door_, asio::buffer(in_.data(), n), then(&Connection::read_browser));
}

void WebServer::Connection::read_door() {
  door_->async_read_some(asio::buffer(out_), then(&Connection::take_from_door));
}

void WebServer::Connection::take_from_door(Code error, std::size_t n) {
  if (stage_ != Stage::kOpen) return;
  if (error) return loop_.machine_ended(), close(kDoorEnded, "the subsystem ended the connection");
  out_begin_ = 0;
  out_end_ = n;
  send_next({}, 0);
}

/// Sends the bytes up to the next line end, as the last frame of a message or as one before it.
void WebServer::Connection::send_next(Code error, std::size_t) {
  is_writing_ = false;
  if (error) return drop();
  if (stage_ != Stage::kOpen) return;
  if (out_begin_ == out_end_) return read_door();
  const std::string_view waiting(out_.data() + out_begin_, out_end_ - out_begin_);
  const std::size_t end = waiting.find('\n');
  const bool is_last = end != std::string_view::npos;
  const std::string_view part = waiting.substr(0, end);
  out_begin_ += part.size() + is_last;
  is_writing_ = true;
  moved_ = now();
  unread_ = INT_MAX;
  socket_.async_write_some(is_last, asio::buffer(part), then(&Connection::send_next));
}

void WebServer::Connection::close(std::uint16_t code, std::string_view reason) {
  if (stage_ == Stage::kClosing || stage_ == Stage::kGone) return;
  if (stage_ < Stage::kKey) return drop();
  enter(Stage::kClosing, kCloseLimit);
  door_.reset();
  const boost::beast::string_view text(reason.data(), std::min(reason.size(), kMaxReason));
  socket_.async_close(websocket::close_reason(static_cast<websocket::close_code>(code), text),
                      [self = shared_from_this()](Code) { self->drop(); });
}

void WebServer::Connection::drop() {
  if (std::exchange(stage_, Stage::kGone) == Stage::kGone) return;
  Code ignored;
  tcp_socket().close(ignored);
  door_.reset();
  loop_.leave(shared_from_this());
}

void WebServer::Connection::check(Nanoseconds at) {
  if (stage_ == Stage::kOpen) return check_open(at);
  if (at < due_) return;
  if (stage_ == Stage::kHead && in_size_ > 0) return refuse(408, "the head of the request has no end after 10 s");
  if (stage_ == Stage::kKey) return close(kSilent, "no key came within 5 s");
  drop();
}

void WebServer::Connection::check_open(Nanoseconds at) {
  if (is_writing_) {
    const int unread = unread_by_other_end(tcp_socket().native_handle());
    if (unread < unread_) moved_ = heard_ = at;
    unread_ = unread;
    if (at - moved_ >= kStuckLimit) return close(kSilent, "the browser read nothing for 5 s");
  }
  if (at - heard_ >= kSilenceLimit)
    return is_reading_ ? close(kSilent, "the browser was silent for 15 s")
                       : close(kDoorEnded, "the subsystem read nothing for 15 s");
  if (!is_reading_ || at - std::max(heard_, pinged_) < kPingAfter) return;
  pinged_ = at;
  socket_.async_ping({}, [self = shared_from_this()](Code) {});
}

WebServer::Loop::Loop(PageContents page, PageKey key, BenchFacts facts, const Tell& tell)
    : page_(std::move(page)), key_(std::move(key)), bench_(std::move(facts), tell) {
  refusals_.report_to(tell);
}

WebServer::Loop::~Loop() {
  if (bench_ready_.is_open()) bench_ready_.release();  // of the server
}

Result<void> WebServer::Loop::open(std::optional<std::uint16_t> port) {
  if (auto opened = bench_.open(); !opened) return opened;
  Code error;
  for (int one = port.value_or(kFirstPort); one <= port.value_or(kLastPort); ++one) {
    acceptor_.close(error);
    acceptor_.open(tcp::v4(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind({asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(one)}, error);
    if (!error) acceptor_.listen(128, error);
    if (error != asio::error::address_in_use) break;
  }
  if (error) {
    const std::string ports = port ? "port " + std::to_string(*port) : "each port from 7440 to 7449";
    return Message(ports + " of 127.0.0.1: " + error.message() + "; name another one: --port N")
        .error(ErrorCode::kSystem);
  }
  link_ = "http://127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port()) + "/#" + key_.text();
  bench_ready_.assign(bench_.descriptor());
  signals_.add(SIGINT);
  signals_.add(SIGTERM);
  signals_.async_wait([this](Code, int) { end(); });
  wait_for_bench();
  accept();
  return {};
}

void WebServer::Loop::run() {
  io_.run();
  bench_.bench().finish();
  all_.clear();
}

std::string WebServer::Loop::admit(bool is_bench) {
  if (all_.size() - strangers().size() >= kMaxSockets) return "64 WebSockets are open, and no more are allowed";
  const auto pages = std::count_if(all_.begin(), all_.end(), [](const auto& one) { return one->is_page(); });
  return is_bench && pages >= kMaxPages ? "12 pages are open, and no more are allowed: close one" : "";
}

std::optional<LocalSocket> WebServer::Loop::door_to(const GateVerdict& verdict, websocket::close_reason& why) {
  LocalSocket mine(io_);
  Code error;
  if (verdict.kind == GateVerdict::Kind::kBench) {
    LocalSocket other(io_);
    asio::local::connect_pair(mine, other, error);
    if (!error) {
      other.native_non_blocking(true, error);
      bench_.enter(other.release());
      return mine;
    }
  } else {
    OwnedDescriptor door = bench_.bench().connect(verdict.machine);
    error = Code(errno, boost::system::system_category());
    if (door.fd >= 0) mine.assign({}, door.fd, error);
    if (mine.is_open()) {
      door.release();
      return mine;
    }
  }
  const bool is_full = error == asio::error::no_descriptors;
  if (is_full) refuse("no descriptor is left (ulimit -n)");
  const std::string reason = is_full ? "chimera-web has no descriptor left (ulimit -n)"
                                     : "no subsystem '" + verdict.machine + "' runs here: " + error.message();
  why = websocket::close_reason(static_cast<websocket::close_code>(is_full ? kFull : kNoMachine),
                                boost::beast::string_view(reason).substr(0, kMaxReason));
  return std::nullopt;
}

void WebServer::Loop::leave(const std::shared_ptr<Connection>& connection) {
  std::erase(all_, connection);
  if (is_ending_ && all_.empty()) io_.stop();
  accept();
}

/// Connections that have shown no key, the oldest first.
std::vector<std::shared_ptr<WebServer::Connection>> WebServer::Loop::strangers() const {
  std::vector<std::shared_ptr<Connection>> found;
  std::copy_if(all_.begin(), all_.end(), std::back_inserter(found), [](const auto& one) { return one->is_stranger(); });
  return found;
}

/// True if one more connection may come: the oldest without a key gives way after kStrangerTime.
bool WebServer::Loop::has_room() const {
  const auto present = strangers();
  return present.size() < kMaxStrangers || now() - present[0]->since() >= kStrangerTime;
}

void WebServer::Loop::accept() {
  if (is_accepting_ || is_ending_ || !has_room()) return;
  is_accepting_ = true;
  acceptor_.async_accept([this](Code error, tcp::socket socket) {
    if (error && !is_ending_) refuse("a connection cannot be accepted: " + error.message() + " (ulimit -n)");
    if (!error) enter(std::move(socket));
    is_accepting_ = false;
    if (!error) accept();
    if (!is_sweeping_) sweep();  // also tries again
  });
}

void WebServer::Loop::enter(tcp::socket socket) {
  Code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  if (const auto present = strangers(); present.size() >= kMaxStrangers) {
    refuse("16 connections without a key are open: the oldest gave way");
    present[0]->drop();
  }
  all_.push_back(std::make_shared<Connection>(*this, std::move(socket)));
  all_.back()->read_head();
}

void WebServer::Loop::sweep() {
  const Nanoseconds at = now();
  for (const auto& connection : std::vector(all_)) connection->check(at);
  refusals_.report_due(at);
  accept();
  is_sweeping_ = !all_.empty() || !is_accepting_ || refusals_.next_due() != kNever;
  if (!is_sweeping_) return;
  sweep_timer_.expires_after(std::chrono::nanoseconds(kSweepPeriod.count));
  sweep_timer_.async_wait([this](Code error) {
    if (!error) sweep();
  });
}

void WebServer::Loop::wait_for_bench() {
  bench_ready_.async_wait(asio::posix::stream_descriptor::wait_read, [this](Code error) {
    if (error) return;
    serve_bench();
    wait_for_bench();
  });
}

void WebServer::Loop::serve_bench() {
  bench_.serve();
  const Nanoseconds due = bench_.next_due();
  bench_timer_.cancel();
  if (due == kNever) return;
  bench_timer_.expires_after(std::chrono::nanoseconds(std::max<std::int64_t>((due - now()).count, 0)));
  bench_timer_.async_wait([this](Code error) {
    if (!error) serve_bench();
  });
}

void WebServer::Loop::end() {
  if (std::exchange(is_ending_, true)) return io_.stop();
  signals_.async_wait([this](Code, int) { end(); });
  Code ignored;
  acceptor_.close(ignored);
  for (const auto& connection : std::vector(all_)) connection->close(kEnds, "chimera-web ends");
  if (all_.empty()) io_.stop();
}

WebServer::WebServer(std::unique_ptr<Loop> loop) : loop_(std::move(loop)) {}
WebServer::~WebServer() = default;
const std::string& WebServer::link() const noexcept { return loop_->link(); }
void WebServer::run() { loop_->run(); }

Result<std::unique_ptr<WebServer>> WebServer::open(const WebRequest& request, PageContents page, Tell tell) {
  auto key = PageKey::make();
  if (!key) return key.error();
  auto loop = std::make_unique<Loop>(std::move(page), *std::move(key), request.facts, tell);
  if (const auto opened = loop->open(request.port); !opened) return opened.error();
  return std::unique_ptr<WebServer>(new WebServer(std::move(loop)));
}

}  // namespace chimera::web
