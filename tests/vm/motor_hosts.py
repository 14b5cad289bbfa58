#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Libraries for motors that others wrote, as hosts of our simulated motors on the kernel's bus: each sends COUNT torques, of which a
motor obeys all that its library writes, and reads as many statuses. `dynpoint device simulate` is the other end.

    motor_hosts.py DRIVE COUNT [INTERFACE]

It prints "answers N wrong M": answers whose torque is more than one step off the one before. The status is 0 if all came and are
right."""
import math
import sys
import time
import types

import can

NUMBER = 1


def torques(count):
    return [0.3 * math.sin(0.1 * i) for i in range(count)]


def judge(wanted, heard, step):
    """The torque that a motor tells is the one of the command that it answers."""
    wrong = sum(abs(a - b) > 1.01 * step for a, b in zip(wanted, heard))
    print(f"answers {len(heard)} wrong {wrong}", flush=True)
    return len(heard) != len(wanted) or wrong


def damiao(count, interface):
    from damiao_motor import DaMiaoMotor
    bus = can.Bus(interface="socketcan", channel=interface, receive_own_messages=False)
    motor = DaMiaoMotor(NUMBER, NUMBER + 16, bus, motor_type="4310")

    def hear(until):
        deadline = time.monotonic() + 2.0
        while time.monotonic() < deadline:
            frame = bus.recv(0.5)
            if frame is not None and frame.arbitration_id == NUMBER + 16:
                motor.process_feedback_frame(bytes(frame.data), frame.arbitration_id)
                if until():
                    return True
        return False

    motor.set_can_timeout(2000)
    motor.write_register(10, 1)
    motor.request_register_reading(9)
    assert hear(lambda: motor.registers.get(9) == 40000), motor.registers
    motor.request_register_reading(23)
    assert hear(lambda: motor.registers.get(23) == 10.0), motor.registers
    motor.enable()
    assert hear(lambda: motor.state.get("status") == "ENABLED"), motor.state
    heard = []
    for torque in torques(count):
        motor.state = {}
        motor.send_cmd_mit(feedforward_torque=torque)
        if hear(lambda: "torq" in motor.state):
            heard.append(motor.state["torq"])
    motor.disable()
    assert hear(lambda: motor.state.get("status") == "DISABLED"), motor.state
    return judge(torques(count), heard, 20 / 4095)


def robstride(count, interface):
    from robstride_dynamics import ParameterType
    from robstride_dynamics.bus import Motor, RobstrideBus
    host = RobstrideBus(interface, {"m": Motor(NUMBER, "rs-02")})
    host.host_id = 0xFD
    host.connect()
    host.write("m", ParameterType.MODE, 0)
    host.write("m", ParameterType.CAN_TIMEOUT, 40000)
    assert host.read("m", ParameterType.CAN_TIMEOUT) == 40000
    host.enable("m")
    heard = []
    for torque in torques(count):
        host.write_operation_frame("m", 0.0, 0.0, 0.0, torque=torque)
        heard.append(host.read_operation_frame("m")[2])
    host.disable("m")
    host.disconnect(disable_torque=False)
    return judge(torques(count), heard, 2 * 34 / 65535)


def cybergear(count, interface):
    from cybergear.cybergear import CyberGearMotor, MotorFeedback
    bus = can.Bus(interface="socketcan", channel=interface)
    motor = CyberGearMotor.__new__(CyberGearMotor)
    motor._bus, motor.can_id, motor.host_can_id, motor._send_timeout = bus, NUMBER, 0xFD, 0.1
    motor._feedback, motor._feedback_listeners, motor._fault_listeners = MotorFeedback(), [], []
    motor._commanded, motor._parameters, motor._parameter_listeners = {}, {}, []

    def hear():
        deadline = time.monotonic() + 2.0
        while time.monotonic() < deadline:
            frame = bus.recv(0.5)
            if frame is not None and frame.arbitration_id >> 24 == 2:
                motor._on_message_received(frame)
                return True
        return False

    motor.run_mode = "operation"
    assert hear()
    motor.set_watchdog_timeout(40000)
    assert hear()
    motor.enable()
    assert hear() and hear() and motor.feedback.mode == 2
    heard = []
    for torque in torques(count):
        motor.motor_control(torque, 0.0, 0.0, 0.0, 0.0)
        if hear():
            heard.append(motor.feedback.torque)
    motor.disable()
    return judge(torques(count), heard, 24 / 65535)


def moteus(count, interface):
    from moteus import protocol
    import moteus as library
    bus = can.Bus(interface="socketcan", channel=interface, fd=True)
    host = library.Controller(id=NUMBER, transport=object())

    def ask(command):
        data = bytes(command.data)
        for length in (8, 12, 16, 20, 24, 32, 48, 64):
            if len(data) <= length:
                data += b"\x50" * (length - len(data))
                break
        bus.send(can.Message(arbitration_id=0x8000 | NUMBER, is_extended_id=True, is_fd=True, bitrate_switch=True, data=data))
        deadline = time.monotonic() + 2.0
        while time.monotonic() < deadline:
            frame = bus.recv(0.5)
            if frame is not None and frame.arbitration_id == NUMBER << 8:
                return protocol.parse_message(types.SimpleNamespace(arbitration_id=frame.arbitration_id,
                                                                    data=bytes(frame.data))).values
        return {}

    assert ask(host.make_custom_query({0x102: library.INT32})).get(0x102) in (4, 5)
    heard = []
    for torque in torques(count):
        said = ask(host.make_position(position=math.nan, velocity=0.0, feedforward_torque=torque, kp_scale=0.0, kd_scale=0.0,
                                      maximum_torque=2.0, watchdog_timeout=2.0, ilimit_scale=0.0, query=True))
        if said.get(0x000) == 10:
            heard.append(said[0x003])
    assert ask(host.make_stop(query=True)).get(0x000) == 0
    return judge(torques(count), heard, 2.0 ** -20)


def main():
    hosts = {"damiao": damiao, "robstride": robstride, "cybergear": cybergear, "moteus": moteus}
    return 1 if hosts[sys.argv[1]](int(sys.argv[2]), sys.argv[3] if len(sys.argv) > 3 else "vcan0") else 0


if __name__ == "__main__":
    sys.exit(main())
