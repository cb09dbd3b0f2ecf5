#include "bench/child.h"

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <malloc.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

namespace lamella::bench {
namespace {

double status_mebibytes(const std::string& field) {
  std::ifstream stream("/proc/self/status");
  for (std::string word; stream >> word;) {
    if (word != field) continue;
    double kibibytes = 0.0;
    stream >> kibibytes;
    return kibibytes / 1024.0;
  }
  return 0.0;
}

bool send_all(int socket, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = ::send(socket, data, size, MSG_NOSIGNAL);
    if (sent <= 0) return false;
    data += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int socket, char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t got = ::recv(socket, data, size, 0);
    if (got <= 0) return false;
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

/// A message is its length in eight bytes, then its bytes.
bool send_message(int socket, const std::string& message) {
  const std::uint64_t size = message.size();
  return send_all(socket, reinterpret_cast<const char*>(&size), sizeof size) &&
         send_all(socket, message.data(), message.size());
}

std::optional<std::string> receive_message(int socket) {
  std::uint64_t size = 0;
  if (!receive_all(socket, reinterpret_cast<char*>(&size), sizeof size)) return std::nullopt;
  std::string message(size, '\0');
  if (!receive_all(socket, message.data(), size)) return std::nullopt;
  return message;
}

[[noreturn]] void serve(int socket, const std::function<Child::Answer()>& make, int cpu_cap) {
  if (cpu_cap > 0) {
    const rlim_t seconds = static_cast<rlim_t>(cpu_seconds()) + static_cast<rlim_t>(cpu_cap);
    const rlimit limit{seconds, seconds + 2};
    ::setrlimit(RLIMIT_CPU, &limit);
  }
  // A child has nothing to do once its parent is gone.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  int code = 0;
  try {
    const Child::Answer answer = make();
    while (const auto request = receive_message(socket)) {
      if (!send_message(socket, answer(*request))) break;
    }
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "  failed: %s\n", failure.what());
    code = 1;
  } catch (...) {
    std::fprintf(stderr, "  failed\n");
    code = 1;
  }
  // Without the parent's destructors and exit handlers, which are not this copy's to run.
  ::_exit(code);
}

std::string describe_end(int status) {
  if (WIFSIGNALED(status)) {
    if (WTERMSIG(status) == SIGXCPU) return "exceeded its CPU time";
    return "killed by signal " + std::to_string(WTERMSIG(status));
  }
  return "ended with code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

double cpu_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void forget_peak() {
  ::malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // proc(5): resets VmHWM to what is resident now
}

double peak_mebibytes() { return status_mebibytes("VmHWM:"); }

Child::Child(const std::function<Answer()>& make, int cpu_cap) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw std::system_error(errno, std::generic_category(), "socketpair");
  }
  std::fflush(nullptr);
  pid_ = ::fork();
  if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (pid_ == 0) {
    ::close(ends[0]);
    serve(ends[1], make, cpu_cap);
  }
  ::close(ends[1]);
  socket_ = ends[0];
}

Child::~Child() { reap(); }

void Child::reap() {
  if (socket_ >= 0) {
    // Children forked later hold copies of this end, so closing it alone would not reach the child.
    ::shutdown(socket_, SHUT_RDWR);
    ::close(socket_);
  }
  socket_ = -1;
  int status = 0;
  if (pid_ > 0 && ::waitpid(pid_, &status, 0) == pid_ && status != 0) error_ = describe_end(status);
  pid_ = -1;
}

std::optional<std::string> Child::ask(const std::string& request) {
  if (socket_ < 0) return std::nullopt;
  if (send_message(socket_, request)) {
    if (auto answer = receive_message(socket_)) return answer;
  }
  reap();
  return std::nullopt;
}

std::optional<std::string> run_in_child(const std::function<std::string()>& work, int cpu_cap) {
  Child child([&work] { return [&work](const std::string&) { return work(); }; }, cpu_cap);
  return child.ask({});
}

}  // namespace lamella::bench
