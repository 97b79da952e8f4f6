// Messages to systemd by the protocol of sd_notify(3).
#pragma once

namespace firmware::controller {

/// Opens the socket that systemd names in NOTIFY_SOCKET; without that variable every message is dropped.
void open_notify_socket();

/// Sends a message such as "WATCHDOG=1". A signal handler may call it.
void notify(const char* message);

/// Tells systemd that stopping or starting takes so many seconds from now on ("EXTEND_TIMEOUT_USEC="), and that the
/// program is alive. A signal handler may call it.
void extend_timeout(double seconds);

}  // namespace firmware::controller
