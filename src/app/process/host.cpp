#include "app/process/host.hpp"

#include <utility>

namespace cloudbow {
namespace {

thread_local const HostCalls* calls_of_thread = nullptr;

}  // namespace

HostScope::HostScope(HostCalls calls) : calls_(std::move(calls)), outer_(calls_of_thread) { calls_of_thread = &calls_; }

HostScope::~HostScope() { calls_of_thread = outer_; }

const HostCalls* HostScope::calls() { return calls_of_thread; }

}  // namespace cloudbow
