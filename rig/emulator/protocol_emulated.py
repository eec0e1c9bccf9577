"""Where pyserial looks for the scheme `emulated://` once this package is among its protocol handler packages."""

from rig.emulator.serial_port import EmulatedSerial as Serial

__all__ = ["Serial"]
