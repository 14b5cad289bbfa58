// SPDX-License-Identifier: BSD-3-Clause
using System;
using System.Runtime.InteropServices;
using System.Threading;

namespace Dynpoint
{
    /// <summary>
    /// Memory that does not move, and that several users share: it is freed when it is closed and nobody uses it any
    /// more, or when nobody has it.
    /// </summary>
    internal abstract class Memory : SafeHandle
    {
        private int users;
        private bool isClosing;

        protected Memory() : base(IntPtr.Zero, true)
        {
        }

        internal IntPtr Start { get; set; }
        internal UIntPtr Bytes { get; set; }

        public override bool IsInvalid
        {
            get { return handle == IntPtr.Zero; }
        }

        /// <summary>Stays until Leave, whoever closes it. Throws if it is closed.</summary>
        internal void Enter(string owner)
        {
            lock (this)
            {
                if (isClosing) throw new ObjectDisposedException(owner);
                users++;
            }
        }

        internal void Leave()
        {
            bool isLast;
            lock (this) isLast = --users == 0 && isClosing;
            if (isLast) Dispose();
        }

        internal void CloseWhenUnused()
        {
            bool isUnused;
            lock (this)
            {
                isClosing = true;
                isUnused = users == 0;
            }
            if (isUnused) Dispose();
        }
    }

    /// <summary>A block, aligned to 64 bytes.</summary>
    internal sealed class Block : Memory
    {
        private readonly long pressure;

        internal Block(UIntPtr bytes)
        {
            long wanted = checked((long)(ulong)bytes + 64);
            SetHandle(Marshal.AllocHGlobal(new IntPtr(wanted)));
            Start = new IntPtr((handle.ToInt64() + 63) & ~63L);
            Bytes = bytes;
            pressure = wanted;
            GC.AddMemoryPressure(pressure);
        }

        protected override bool ReleaseHandle()
        {
            Marshal.FreeHGlobal(handle);
            GC.RemoveMemoryPressure(pressure);
            return true;
        }
    }

    /// <summary>The bytes that a compiler made.</summary>
    internal sealed unsafe class CompiledBytes : Memory
    {
        internal CompiledBytes(Compiled made)
        {
            SetHandle(made.Bytes);
            Start = made.Bytes;
            Bytes = made.Size;
        }

        protected override bool ReleaseHandle()
        {
            Compiled made = new Compiled { Bytes = handle, Size = Bytes };
            Native.dpt_compiled_free(&made);
            return true;
        }
    }

    /// <summary>What one thread at a time may use: a second one gets an exception, and nothing happens.</summary>
    public abstract class Exclusive
    {
        private int busy;

        /// <summary>The address of what is used, or zero once it is closed.</summary>
        internal IntPtr Address;

        internal IntPtr Enter(string what)
        {
            if (Interlocked.CompareExchange(ref busy, 1, 0) != 0)
                throw new InvalidOperationException(what + ": another call is in this " + GetType().Name
                                                    + "; one thread at a time may use it");
            IntPtr address = Address;
            if (address != IntPtr.Zero) return address;
            Leave();
            throw new ObjectDisposedException(GetType().Name);
        }

        internal void Leave()
        {
            Volatile.Write(ref busy, 0);
        }

        /// <summary>For Dispose: false if it is closed already.</summary>
        internal bool EnterToClose(string what)
        {
            if (Interlocked.CompareExchange(ref busy, 1, 0) != 0)
                throw new InvalidOperationException(what + ": another call is in this " + GetType().Name);
            if (Address != IntPtr.Zero) return true;
            Leave();
            return false;
        }
    }
}
