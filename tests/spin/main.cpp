// Prints the controller's states, requests and reasons as a Promela model, for SPIN to explore whole.
//
// What stands in tables in firmware/loop (mode.hpp, trip.hpp) is printed from them, line by line; the order in which a
// period asks them is ControlLoop::step()'s and is written out here. One turn of the model's loop is one period, in
// which any requests may have come, the button may be down, any reason may turn up, and the drive may have arrived.
// tests/checks/spin.bash says what must hold and runs it.
#include <cstdio>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/loop/common/mode.hpp"
#include "firmware/loop/common/trip.hpp"

namespace {

using namespace firmware;

std::string upper(std::string_view prefix, std::string_view name) {
  std::string text(prefix);
  for (const char c : name) text += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

template <class Enum>
void print_names(std::string_view prefix, Enum last) {
  for (int i = 0; i <= static_cast<int>(last); ++i) {
    std::printf("#define %s %d\n", upper(prefix, name(static_cast<Enum>(i))).c_str(), i);
  }
}

/// What the tables say of a reason; two reasons of which they say the same are one to the loop, but for the question
/// whether the first one lasts.
std::string behaviour(Reason reason) {
  std::string text;
  for (int m = 0; m <= static_cast<int>(Mode::safe); ++m) {
    for (const bool powered : {false, true}) text += name(event_of(reason, static_cast<Mode>(m), powered));
  }
  for (const bool told : {is_stop(reason), takes_heartbeat(reason), loses_power(reason), reason == Reason::force}) {
    text += told ? '1' : '0';
  }
  return text;
}

/// Two faults of each behaviour, or the only one: all that may turn up in any period but a press.
std::vector<Reason> representatives() {
  std::map<std::string, int> seen;
  std::vector<Reason> chosen;
  for (int r = static_cast<int>(Reason::stop_button) + 1; r <= static_cast<int>(last_reason); ++r) {
    const auto reason = static_cast<Reason>(r);
    if (seen[behaviour(reason)]++ < 2) chosen.push_back(reason);
  }
  return chosen;
}

/// Event `e` happens in `mode`: one line of the table of transitions each.
void print_transitions() {
  std::puts("inline follow(e) {\n  if");
  for (const Transition& line : transitions) {
    std::printf("  :: mode == %s && e == %s -> mode = %s;", upper("M_", name(line.from)).c_str(),
                upper("E_", name(line.event)).c_str(), upper("M_", name(line.to)).c_str());
    if (line.power == Power::give) std::printf(" give();");
    if (line.power == Power::take) std::printf(" power = false;");
    std::puts("");
  }
  std::puts(
      "  :: else -> skip\n  fi;\n"
      "  if :: e == E_CHECKED -> proven = true :: else -> skip fi;\n"
      "  if :: e == E_ARM || mode == M_IDLE -> proven = false; armed = false :: else -> skip fi;\n"
      "}");
}

/// A request is taken up where its line and what it needs allow it.
void print_rules() {
  std::puts("inline ask(r) {\n  event = E_NONE;\n  if");
  for (const RequestRule& rule : request_rules) {
    std::string needs;
    if ((rule.needs & need::standing) != 0) needs += " && at_rest";
    if ((rule.needs & need::no_hazard) != 0) needs += " && reason == R_NONE";
    if ((rule.needs & need::proven) != 0) needs += " && proven";
    if ((rule.needs & need::moving) != 0) needs += " && (!standing || power)";
    std::printf("  :: r == %s && mode == %s%s -> event = %s\n", upper("Q_", name(rule.request)).c_str(),
                upper("M_", name(rule.mode)).c_str(), needs.c_str(), upper("E_", name(rule.event)).c_str());
  }
  std::puts("  :: else -> skip\n  fi\n}");
}

/// What a reason does: event_of() for every reason and state, with and without power.
void print_reasons() {
  std::puts("inline event_of_reason() {\n  if");
  for (int r = 1; r <= static_cast<int>(last_reason); ++r) {
    for (int m = 0; m <= static_cast<int>(Mode::safe); ++m) {
      for (const bool powered : {false, true}) {
        const auto reason = static_cast<Reason>(r);
        const auto mode = static_cast<Mode>(m);
        std::printf("  :: reason == %s && mode == %s && %spower -> event = %s\n", upper("R_", name(reason)).c_str(),
                    upper("M_", name(mode)).c_str(), powered ? "" : "!",
                    upper("E_", name(event_of(reason, mode, powered))).c_str());
      }
    }
  }
  std::puts("  fi\n}");
  std::puts("inline read_reason() {\n  stops = false; starves = false; rearms = false;\n  if");
  for (int r = 0; r <= static_cast<int>(last_reason); ++r) {
    const auto reason = static_cast<Reason>(r);
    std::printf("  :: reason == %s -> skip;%s%s%s\n", upper("R_", name(reason)).c_str(),
                is_stop(reason) ? " stops = true;" : "", takes_heartbeat(reason) ? " starves = true;" : "",
                loses_power(reason) ? " rearms = true;" : "");
  }
  std::puts("  fi\n}");
}

/// The controller's state, and what gives power.
void print_declarations() {
  std::puts(R"(
byte mode = M_IDLE, reason, first_reason, mode_before, first_before, event;
bool power, power_before;   /* wanted; off first, on last */
bool proven;                /* an arming has passed */
bool standing = true, held; /* of the way to rest */
bool at_rest = true;
bool expects;               /* the reason that led to safe may last */
bool stops, starves, rearms;
bool pressed;
bool armed;                 /* ghost: a person has asked for it since idle, and the comparison was in order */
bool asked_arm, asked_rest; /* ghost: in force */

inline give() {
  assert(!pressed);                         /* nothing gives power while the button is down */
  assert(reason == R_NONE);                 /* nor while something is wrong */
  assert(asked_arm || (asked_rest && armed && proven)); /* power never without arming: a person has asked for it */
  if :: asked_arm -> armed = true :: else -> skip fi;
  power = true
})");
}

/// A period, in ControlLoop::step()'s order.
void print_period() {
  std::puts(R"(inline trip() {
  read_reason();
  if :: rearms -> proven = false :: else -> skip fi;
  if
  :: mode == M_SAFE ->
     if :: (!standing || power) && !held -> held = true :: else -> skip fi;
     follow(E_HALT)
  :: else ->
     event_of_reason();
     first_reason = reason;
     expects = true;
     held = (event == E_HALT);
     follow(event);
     standing = !power && held
  fi
}

inline matters() { /* into event: E_NONE, it does not */
  read_reason();
  event = E_TRIP;
  if
  :: mode == M_IDLE && !stops && !starves && reason != R_STOP_REQUESTED -> event = E_NONE
  :: mode == M_SAFE && reason == R_FORCE && standing && !power -> event = E_NONE
  :: mode == M_SAFE && reason != R_FORCE && expects && reason == first_reason && !stops -> event = E_NONE
  :: mode == M_SAFE && reason != R_FORCE && !stops && !starves && standing && !power -> event = E_NONE
  :: else -> skip
  fi
}

active proctype controller() {
  do
  ::
     mode_before = mode; first_before = first_reason; power_before = power; asked_rest = false;
     /* the world */
     if :: pressed = true :: pressed = false fi;
     if :: mode == M_SAFE && !standing -> standing = true :: skip fi;
     at_rest = (mode == M_IDLE || (mode == M_SAFE && standing)) && !power;
     if
     :: pressed -> reason = R_STOP_BUTTON
     :: !pressed -> reason = R_NONE)");
  for (const Reason reason : representatives()) {
    std::printf("     :: !pressed -> reason = %s\n", upper("R_", name(reason)).c_str());
  }
  std::puts("     :: !pressed && (mode == M_RUNNING || mode == M_HOLDING) -> reason = R_REFERENCE_ENDED");
  std::puts("     fi;\n     /* requests: any of them, in the order in which the loop takes them up */");
  for (const Request stop : {Request::stop, Request::end}) {
    std::printf(
        "     if :: reason == R_NONE && mode != M_SAFE -> ask(%s); if :: event != E_NONE -> reason = "
        "R_STOP_REQUESTED :: else -> skip fi :: else -> skip :: skip fi;\n",
        upper("Q_", name(stop)).c_str());
  }
  std::puts(
      "     if :: mode == M_SAFE && reason == R_NONE -> ask(Q_STOP); if :: event != E_NONE -> reason = "
      "R_STOP_REQUESTED; "
      "trip(); reason = R_NONE :: else -> skip fi :: else -> skip :: skip fi;\n"
      "     at_rest = (mode == M_IDLE || (mode == M_SAFE && standing)) && !power;");
  for (const Request request : {Request::acknowledge, Request::rest, Request::arm, Request::disarm, Request::start,
                                Request::hold, Request::resume}) {
    std::printf("     if :: ask(%s); if :: event == E_NONE -> skip :: else -> ", upper("Q_", name(request)).c_str());
    if (request == Request::rest) std::printf("asked_rest = true; ");
    std::printf("follow(event); ");
    if (request == Request::rest) std::printf("standing = false; held = false; expects = false; ");
    if (request == Request::arm)
      std::printf("asked_arm = true; first_reason = R_NONE; first_before = R_NONE; mode_before = M_ARMING; ");
    if (request == Request::start) std::printf("first_reason = R_NONE; ");
    std::puts("fi :: skip fi;");
  }
  std::puts(R"(     /* arming gets on, a run begins */
     if :: mode == M_ARMING && reason == R_NONE && !power -> follow(E_COMPARED)
        :: mode == M_ARMING && reason == R_NONE && power -> follow(E_CHECKED)
        :: mode == M_READY && reason == R_NONE -> follow(E_IN_POSITION)
        :: skip fi;
     if
     :: reason != R_NONE -> matters(); if :: event == E_TRIP -> trip() :: else -> skip fi
     :: else -> skip
     fi;
     if :: mode == M_SAFE && (held || standing) -> follow(E_ARRIVED) :: else -> skip fi;
     if :: mode != M_ARMING && !power -> asked_arm = false :: else -> skip fi;

     /* what must hold after every period */
     assert(!pressed || !power);                              /* a press ends in no power, in every state */
     assert(!pressed || mode == M_SAFE);                      /* … and in safe: from every state there is that way */
     assert(!power || armed);                                 /* power never without arming */
     assert(power_before || !power || asked_arm || asked_rest); /* nothing else switches it on */
     assert(mode != M_IDLE || !power);
     assert(!(mode_before == M_SAFE && mode == M_SAFE) || first_reason == first_before); /* the first reason is kept */
     assert(mode != M_SAFE || first_reason != R_NONE);
     reason = R_NONE; event = E_NONE; stops = false; starves = false; rearms = false; at_rest = false; asked_rest = false;
     mode_before = M_IDLE; first_before = R_NONE; power_before = false
  od
})");
}

}  // namespace

int main() {
  std::puts("/* Printed from firmware/loop/common/mode.hpp and trip.hpp by tests/spin/main.cpp. */");
  print_names("M_", Mode::safe);
  print_names("E_", last_event);
  std::printf("#define E_NONE 255\n");
  print_names("Q_", last_request);
  print_names("R_", last_reason);
  print_declarations();
  print_transitions();
  print_rules();
  print_reasons();
  print_period();
}
