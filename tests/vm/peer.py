#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Motor controllers on a CAN bus that know nothing of this library: ODrive's CANSimple, spoken by python-can with ODrive's own
message definitions (DBC files of the odrive-can package on PyPI, firmware 0.5.6 and 0.6.10) through cantools.

    peer.py [--interface vcan0] --axis NODE:FIRMWARE... [--rate HZ] [--heartbeat S] [--inertia KGM2] [--friction NMS]
            [--watchdog S]

NODE is 0 to 7, FIRMWARE 0.5 or 0.6. An axis says its encoder estimates at RATE, as far as python keeps up, and obeys
Set_Axis_State (idle, closed loop), Set_Controller_Mode, Set_Input_Torque, Clear_Errors, Estop and, with 0.6, requests for its
version. It is a mass with viscous friction that each estimate takes a period of RATE further: position is a matter of how many
were sent, not of the clock. In closed loop with torque control and passed-through input, and only then, the torque moves it.
WATCHDOG (0: none) ends the closed loop when no message came for so long.

It says "ready", and when it is terminated one JSON object on one line, all of it flat:
"NODE.MESSAGE.count", "NODE.MESSAGE.crc" (CRC-32 of all payloads in order), "NODE.MESSAGE.SIGNAL" (the last value);
"NODE.sent.MESSAGE", "NODE.state", "NODE.error", "NODE.position" (rev), "NODE.velocity" (rev/s); "errors" (error frames),
"strangers" (frames that are in no definition, or for no axis here).
"""
import argparse
import contextlib
import importlib.util
import json
import math
import os
import re
import signal
import socket
import sys
import time
import zlib

import can
import cantools

IDLE, CLOSED_LOOP = 1, 8
# Of frames that are heard before it says something again, where python does not keep up; and as bytes, of those that may wait.
BACKLOG, BUFFER = 256, 1 << 24
SO_RCVBUFFORCE = 33
TORQUE_CONTROL, PASS_THROUGH = 1, 1
FIRMWARE = {
    "0.5": {"dbc": "odrive-cansimple-0.5.6.dbc", "estop": 0x4000, "watchdog": 0x800},
    "0.6": {"dbc": "odrive-cansimple-0.6.10.dbc", "estop": 0x02000000, "watchdog": 0x01000000},
}
VERSION = {"Protocol_Version": 2, "Hw_Version_Major": 4, "Hw_Version_Minor": 4, "Hw_Version_Variant": 58,
           "Fw_Version_Major": 0, "Fw_Version_Minor": 6, "Fw_Version_Revision": 10, "Fw_Version_Unreleased": 0}


def definitions(firmware, nodes):
    """The messages of these axes. To read those of all eight would take a second more."""
    folder = importlib.util.find_spec("odrive_can").submodule_search_locations[0]
    kept, foreign = [], False
    with open(os.path.join(folder, "dbc", FIRMWARE[firmware]["dbc"]), encoding="utf-8") as file:
        for line in file:
            of = re.match(r"(?:BO_|VAL_|SIG_VALTYPE_|BO_TX_BU_) (\d+) ", line)
            if of or not line.startswith(" SG_ "):
                foreign = of is not None and int(of[1]) >> 5 not in nodes
            if not foreign:
                kept.append(line)
    return cantools.database.load_string("".join(kept), "dbc")


class Axis:
    def __init__(self, node, firmware, database, options):
        self.node, self.faults, self.options = node, FIRMWARE[firmware], options
        prefix = f"Axis{node}_"
        self.messages = {m.name[len(prefix):]: m for m in database.messages if m.name.startswith(prefix)}
        self.names = {m.frame_id: name for name, m in self.messages.items()}
        # Firmware 0.5.6 knows it, its DBC does not.
        self.names.setdefault(node << 5 | 0x02, "Estop")
        self.state, self.error, self.disarm_reason = IDLE, 0, 0
        self.mode = (3, PASS_THROUGH)
        self.torque = self.position = self.velocity = 0.0
        self.fed = time.monotonic()
        self.report = {}

    def step(self, period):
        """The exact motion over a period of constant torque."""
        drives = self.state == CLOSED_LOOP and self.mode == (TORQUE_CONTROL, PASS_THROUGH)
        torque = self.torque if drives else 0.0
        inertia, friction = self.options.inertia, self.options.friction
        final = torque / friction / math.tau
        decay = math.exp(-friction / inertia * period)
        self.position += final * period + (self.velocity - final) * (1.0 - decay) * inertia / friction
        self.velocity = final + (self.velocity - final) * decay

    def disarm(self, error):
        self.error |= error
        self.disarm_reason = error
        self.state, self.torque = IDLE, 0.0

    def watch(self, now):
        if self.options.watchdog and self.state == CLOSED_LOOP and now - self.fed > self.options.watchdog:
            self.disarm(self.faults["watchdog"])

    def signals(self, name):
        """What a message of this axis says now, or None if it is not one that it sends."""
        values = {
            "Heartbeat": {"Axis_Error": self.error, "Axis_State": self.state},
            "Get_Encoder_Estimates": {"Pos_Estimate": self.position, "Vel_Estimate": self.velocity},
            "Get_Error": {"Active_Errors": self.error, "Disarm_Reason": self.disarm_reason},
            "Get_Torques": {"Torque_Target": self.torque, "Torque_Estimate": self.torque},
            "Get_Version": VERSION,
        }.get(name)
        if values is None or name not in self.messages:
            return None
        return {signal.name: values.get(signal.name, 0) for signal in self.messages[name].signals}

    def say(self, bus, name):
        message = self.messages[name]
        bus.send(can.Message(arbitration_id=message.frame_id, is_extended_id=False,
                             data=message.encode(self.signals(name))))
        self.count(f"sent.{name}", 1)

    def count(self, key, more):
        self.report[key] = self.report.get(key, 0) + more

    def hear(self, bus, frame):
        name = self.names[frame.arbitration_id]
        self.fed = time.monotonic()
        if frame.is_remote_frame:
            self.count(f"{name}.requests", 1)
            if self.signals(name) is not None:
                self.say(bus, name)
            return
        # A frame may be shorter than its definition: a torque in four bytes.
        values = {} if not frame.data else self.messages[name].decode(
            bytes(frame.data), decode_choices=False, allow_truncated=True)
        self.count(f"{name}.count", 1)
        self.report[f"{name}.crc"] = zlib.crc32(frame.data, self.report.get(f"{name}.crc", 0))
        for signal_name, value in values.items():
            self.report[f"{name}.{signal_name}"] = value
        self.obey(name, values)

    def obey(self, name, values):
        if name == "Set_Axis_State":
            wanted = values["Axis_Requested_State"]
            if wanted == IDLE:
                self.state, self.torque = IDLE, 0.0
            elif wanted == CLOSED_LOOP and not self.error:
                self.state, self.torque = CLOSED_LOOP, 0.0
        elif name == "Set_Controller_Mode":
            self.mode = (values["Control_Mode"], values["Input_Mode"])
        elif name == "Set_Input_Torque":
            self.torque = values["Input_Torque"]
        elif name == "Clear_Errors":
            self.error = self.disarm_reason = 0
        elif name == "Estop":
            self.disarm(self.faults["estop"])


def serve(bus, axes, options, stopping):
    strangers = errors = 0
    period = 1.0 / options.rate
    next_estimate = next_heartbeat = time.monotonic()
    owners = {frame_id: axis for axis in axes for frame_id in axis.names}
    while not stopping:
        now = time.monotonic()
        if now >= next_heartbeat:
            next_heartbeat = max(next_heartbeat + options.heartbeat, now)
            for axis in axes:
                axis.say(bus, "Heartbeat")
        if now >= next_estimate:
            next_estimate = max(next_estimate + period, now)
            for axis in axes:
                axis.watch(now)
                axis.step(period)
                axis.say(bus, "Get_Encoder_Estimates")
        wait = max(0.0, min(next_estimate, next_heartbeat) - time.monotonic())
        for _ in range(BACKLOG):
            frame = bus.recv(wait)
            if frame is None:
                break
            wait = 0.0
            owner = None if frame.is_extended_id else owners.get(frame.arbitration_id)
            if frame.is_error_frame:
                errors += 1
            elif owner is None:
                strangers += 1
            else:
                owner.hear(bus, frame)
    return {"errors": errors, "strangers": strangers}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--interface", default="vcan0")
    parser.add_argument("--axis", action="append", required=True)
    parser.add_argument("--rate", type=float, default=500.0)
    parser.add_argument("--heartbeat", type=float, default=0.1)
    parser.add_argument("--inertia", type=float, default=1e-4)
    parser.add_argument("--friction", type=float, default=1e-3)
    parser.add_argument("--watchdog", type=float, default=0.0)
    options = parser.parse_args()
    stopping = []
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stopping.append(True))
    pairs = [(int(node), firmware) for node, firmware in (axis.split(":") for axis in options.axis)]
    databases = {firmware: definitions(firmware, [node for node, _ in pairs])
                 for firmware in {firmware for _, firmware in pairs}}
    axes = [Axis(node, firmware, databases[firmware], options) for node, firmware in pairs]
    with can.Bus(interface="socketcan", channel=options.interface) as bus:
        with contextlib.suppress(PermissionError):
            bus.socket.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, BUFFER)
        print("ready", flush=True)
        report = serve(bus, axes, options, stopping)
    for axis in axes:
        report.update({f"{axis.node}.{key}": value for key, value in axis.report.items()})
        report.update({f"{axis.node}.state": axis.state, f"{axis.node}.error": axis.error,
                       f"{axis.node}.position": axis.position, f"{axis.node}.velocity": axis.velocity})
    print(json.dumps(report, sort_keys=True), flush=True)


if __name__ == "__main__":
    sys.exit(main())
