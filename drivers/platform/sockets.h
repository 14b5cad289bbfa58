/* SPDX-License-Identifier: BSD-3-Clause */
/* Where the system declares addresses and sockets. */
#ifndef DPT_PLATFORM_SOCKETS_H
#define DPT_PLATFORM_SOCKETS_H

#ifdef _WIN32
#include <winsock2.h>
#include <ws2tcpip.h>
enum { IN_LOOPBACKNET = 127 };
#else
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#endif

/* Whether this machine has the address ::1 at all. */
int sockets_have_local_6(void);

#endif
