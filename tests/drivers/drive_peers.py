#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Libraries that others wrote, against our frames of motors (tests/drivers/test_drive.c): damiao-motor (MIT), robstride-dynamics
(MIT), robstride (MIT), python-cybergear (MIT) and moteus (Apache-2.0), from PyPI. They are the host's side. robstride-dynamics
writes commands; its scale has 65,534 steps, the manual's and robstride's have 65,535, so it is allowed one step more.

    drive_peers.py TEST_DRIVE [COUNT [DRIVE...]]

Each way COUNT frames. Ours: a command must say to the peer's own scale what ours says, and differ from the peer's own frame by one
step at most; a status must be decoded by the peer within one step. Theirs: commands, and of moteus statuses, that we decode within
one step. It prints "DRIVE ours COUNT worst STEPS, theirs COUNT worst STEPS" a drive; the status is 1 if one is above 1."""
import math
import random
import struct
import subprocess
import sys
import types

NUMBER, ANSWER = 3, 19


class Bus:
    """What a library sends."""

    def __init__(self):
        self.sent = None

    def send(self, message, timeout=None):
        self.sent = message


def scaled(data, bits_from, bits, limit):
    """A number of a frame, by the peer's formula of +-limit."""
    number = int.from_bytes(data, "big") >> (8 * len(data) - bits_from - bits) & ((1 << bits) - 1)
    return number * (2 * limit) / ((1 << bits) - 1) - limit


class Damiao:
    position, velocity, torque = 12.5, 30.0, 10.0
    torque_step, position_step, velocity_step = 20 / 4095, 25 / 65535, 60 / 4095

    def __init__(self):
        from damiao_motor import DaMiaoMotor
        self.motor = DaMiaoMotor(NUMBER, ANSWER, Bus(), motor_type="4310")

    def command(self, torque):
        data = self.motor.encode_cmd_msg(0.0, 0.0, torque, 0.0, 0.0)
        return NUMBER, 0, data

    def torque_of(self, identifier, data):
        return scaled(data, 52, 12, self.torque)

    def status(self, identifier, data):
        said = self.motor.decode_sensor_feedback(data, arbitration_id=identifier)
        assert said["status"] == "ENABLED" and said["can_id"] == NUMBER and identifier == ANSWER
        return said["pos"], said["vel"], said["torq"]


class RobStride:
    position, velocity, torque = 4 * math.pi, 44.0, 17.0
    slack = 1.0
    torque_step, position_step, velocity_step = 34 / 65535, 8 * math.pi / 65535, 88 / 65535

    def __init__(self):
        from robstride_dynamics.bus import Motor, RobstrideBus
        self.host = RobstrideBus("none", {"m": Motor(NUMBER, "rs-02")}, calibration=None)
        self.host.host_id = 0xFD
        self.host.channel_handler = self.bus = Bus()
        self.host.disconnect = lambda *_: None
        from robstride.client import Client
        self.reader = Client.__new__(Client)
        self.reader.host_can_id = 0xFD

    def command(self, torque):
        self.host.write_operation_frame("m", 0.0, 0.0, 0.0, torque=torque)
        return self.bus.sent.arbitration_id, 4, bytes(self.bus.sent.data)

    def torque_of(self, identifier, data):
        return ((identifier >> 8 & 0xFFFF) / 0x7FFF - 1.0) * self.torque

    def status(self, identifier, data):
        said = self.reader._parse_feedback_resp(types.SimpleNamespace(arbitration_id=identifier, data=data), NUMBER, 1)
        assert not said.errors
        return said.angle, said.velocity, said.torque


class CyberGear:
    position, velocity, torque = 12.5, 30.0, 12.0
    torque_step, position_step, velocity_step = 24 / 65535, 25 / 65535, 60 / 65535

    def __init__(self):
        from cybergear.cybergear import CyberGearMotor, MotorFeedback
        self.motor = CyberGearMotor.__new__(CyberGearMotor)
        self.bus = self.motor._bus = Bus()
        self.motor.can_id, self.motor.host_can_id, self.motor._send_timeout = NUMBER, 0xFD, 0.1
        self.motor._feedback, self.motor._feedback_listeners, self.motor._fault_listeners = MotorFeedback(), [], []

    def command(self, torque):
        self.motor.motor_control(torque, 0.0, 0.0, 0.0, 0.0)
        return self.bus.sent.arbitration_id, 4, bytes(self.bus.sent.data)

    def torque_of(self, identifier, data):
        return (identifier >> 8 & 0xFFFF) * 24 / 65535 - 12

    def status(self, identifier, data):
        self.motor._on_message_received(types.SimpleNamespace(arbitration_id=identifier, data=data))
        said = self.motor.feedback
        assert said.mode == 2 and not said.faults.has_fault
        return said.position, said.velocity, said.torque


class Moteus:
    position, velocity, torque = 8 * math.pi, 30.0, 10.0
    torque_step, position_step, velocity_step = 2.0 ** -22, math.tau * 2.0 ** -22, math.tau * 2.0 ** -22

    def __init__(self):
        import moteus
        from moteus import multiplex, protocol
        self.moteus, self.protocol, self.multiplex = moteus, protocol, multiplex
        self.host = moteus.Controller(id=NUMBER, transport=object())

    def command(self, torque):
        command = self.host.make_position(position=math.nan, velocity=0.0, feedforward_torque=torque, kp_scale=0.0,
                                          kd_scale=0.0, maximum_torque=5.0, watchdog_timeout=0.05, ilimit_scale=0.0,
                                          query=True)
        return 0x8000 | NUMBER, 12, padded(command.data)

    def torque_of(self, identifier, data):
        said = self.protocol.parse_registers(data)
        register = self.protocol.Register
        assert identifier == 0x8000 | NUMBER and not said.errors
        assert said.command[register.MODE] == 10 and math.isnan(said.command[register.COMMAND_POSITION])
        assert said.command[register.COMMAND_KP_SCALE] == said.command[register.COMMAND_KD_SCALE] == 0
        assert abs(said.command[register.COMMAND_TIMEOUT] - 0.05) < 1e-6
        assert said.command[register.COMMAND_POSITION_MAX_TORQUE] == 5.0
        assert register.POSITION in [asked for asked, _ in said.query]
        return said.command[register.COMMAND_FEEDFORWARD_TORQUE]

    def status(self, identifier, data):
        said = self.protocol.parse_message(types.SimpleNamespace(arbitration_id=identifier, data=data))
        register = self.protocol.Register
        assert said.id == NUMBER and said.values[register.MODE] == 10
        return (math.tau * said.values[register.POSITION], math.tau * said.values[register.VELOCITY],
                said.values[register.TORQUE])

    def answer(self, position, velocity, torque):
        """A status as a moteus would send it, by the library's own writer: in 32-bit floats."""
        import io
        buffer = io.BytesIO()
        writer = self.protocol.Writer(buffer)
        writer.write_int8(self.multiplex.REPLY_BASE | 0x01)
        writer.write_varuint(0x000)
        writer.write_int8(10)
        writer.write_int8(self.multiplex.REPLY_BASE | 0x0C | 0x03)
        writer.write_varuint(0x001)
        for value in (position, velocity, torque):
            writer.write_f32(value)
        return NUMBER << 8, 8, padded(buffer.getvalue())


def padded(data):
    """To a length that CAN-FD has, as the library's transport does."""
    for length in (8, 12, 16, 20, 24, 32, 48, 64):
        if len(data) <= length:
            return bytes(data) + b"\x50" * (length - len(data))
    raise ValueError("too long")


DRIVES = {"damiao": Damiao, "robstride": RobStride, "cybergear": CyberGear, "moteus": Moteus}


def judge_ours(peer, lines):
    """The largest error, in steps."""
    worst = 0.0
    for line in lines:
        kind, torque, position, velocity, identifier, _, data = line.split()
        torque, identifier, data = float(torque), int(identifier, 16), bytes.fromhex(data)
        if kind == "c":
            slack = getattr(peer, "slack", 0.0)
            worst = max(worst, abs(peer.torque_of(identifier, data) - torque) / peer.torque_step - slack)
            their_id, _, their_data = peer.command(torque)
            if not isinstance(peer, Moteus):
                # The rest of the frame is the same but for the way of rounding zero.
                assert their_id & 0x1F0000FF == identifier & 0x1F0000FF and len(their_data) == len(data)
                worst = max(worst, abs(peer.torque_of(their_id, their_data) - peer.torque_of(identifier, data)) /
                            peer.torque_step - slack)
                for mine, theirs in zip(struct.unpack(">H", data[:2]), struct.unpack(">H", their_data[:2])):
                    worst = max(worst, abs(mine - theirs))
        else:
            their_position, their_velocity, their_torque = peer.status(identifier, data)
            worst = max(worst, abs(their_position - math.tau * float(position)) / peer.position_step,
                        abs(their_velocity - math.tau * float(velocity)) / peer.velocity_step,
                        abs(their_torque - torque) / peer.torque_step)
    return worst


def their_lines(peer, count, numbers):
    for i in range(count):
        torque = numbers.uniform(-peer.torque, peer.torque)
        if i % 2 and hasattr(peer, "answer"):
            torque = struct.unpack("f", struct.pack("f", torque))[0]
            position = struct.unpack("f", struct.pack("f", numbers.uniform(-4.0, 4.0)))[0]
            velocity = struct.unpack("f", struct.pack("f", numbers.uniform(-4.0, 4.0)))[0]
            identifier, flags, data = peer.answer(position, velocity, torque)
            yield f"s {torque!r} {position!r} {velocity!r} {identifier:x} {flags} {data.hex()}\n"
        else:
            identifier, flags, data = peer.command(torque)
            yield f"c {torque!r} 0 0 {identifier:x} {flags} {data.hex()}\n"


def main():
    program, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 2000
    status = 0
    for name in sys.argv[3:] or DRIVES:
        peer = DRIVES[name]()
        ours = subprocess.run([program, "write", name, str(count), "1"], capture_output=True, text=True, check=True)
        lines = ours.stdout.splitlines()
        worst = judge_ours(peer, lines)
        theirs = subprocess.run([program, "read", name], input="".join(their_lines(peer, count, random.Random(1))),
                                capture_output=True, text=True, check=True).stdout.split()
        print(f"{name} ours {len(lines)} worst {worst:.3f}, theirs {theirs[0]} worst {float(theirs[2]):.3f}, "
              f"{theirs[1]} not understood", flush=True)
        if len(lines) != count or int(theirs[0]) != count or int(theirs[1]) or worst > 1.0 + 1e-4 or float(theirs[2]) > 1.0 + 1e-4 + getattr(peer, "slack", 0.0):
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
