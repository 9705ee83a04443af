// Usage: PROGRAM FOLDER
// Runs a fuzz target once on each file of FOLDER, in the order of their names. Each target is linked with
// this driver wherever it is not linked with libFuzzer. A target that aborts, crashes or hangs ends the
// program, which names the input first. Exits with 2 if the folder cannot be read or holds no file.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
// Defined by sanitizers.
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)());

namespace {

constexpr unsigned kMostSeconds = 30;  // per input, as in ci/fuzz.sh

// A signal handler may not allocate, therefore it reads the name from here.
std::array<char, 4096> input{};

void print(const char* text) {
  if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) ::_exit(3);
}

void print_failure(const char* what) {
  print(what);
  print(input.data());
  print("\n");
}

// The handler is reset when it is called: the signal that is raised again ends the program.
void end_by(int signal) {
  print_failure(signal == SIGALRM ? "no end on input " : "failed on input ");
  ::raise(signal);
}

// A sanitizer ends the program without a signal.
void end_by_sanitizer() { print_failure("finding on input "); }

// The handlers have a stack of their own, because a recursion without end leaves none.
void install_handlers() {
  static std::array<char, 64 << 10> bytes;
  stack_t stack{};
  stack.ss_sp = bytes.data();
  stack.ss_size = bytes.size();
  ::sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_handler = end_by;
  action.sa_flags = SA_ONSTACK | SA_RESETHAND;
  for (const int signal : {SIGABRT, SIGALRM, SIGBUS, SIGFPE, SIGILL, SIGSEGV})
    ::sigaction(signal, &action, nullptr);
  if (__sanitizer_set_death_callback != nullptr) __sanitizer_set_death_callback(end_by_sanitizer);
}

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  if (files.empty()) throw std::runtime_error(folder + ": no file");
  std::sort(files.begin(), files.end());
  return files;
}

// Exactly as many bytes are allocated as the file has: the address sanitizer then reports a read beyond them.
std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::vector<std::uint8_t> bytes(std::filesystem::file_size(path));
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return bytes;
}

// An exception that leaves the target terminates the program, as in libFuzzer.
void run_target(const std::vector<std::uint8_t>& bytes) noexcept {
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

void replay(const std::string& path) {
  const std::vector<std::uint8_t> bytes = bytes_of(path);
  std::snprintf(input.data(), input.size(), "%s", path.c_str());
  ::alarm(kMostSeconds);
  run_target(bytes);
  ::alarm(0);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  try {
    const std::vector<std::string> files = files_in(argv[1]);
    install_handlers();
    for (const std::string& path : files) replay(path);
    std::printf("%zu inputs of %s\n", files.size(), argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
