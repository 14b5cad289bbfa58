// SPDX-License-Identifier: BSD-3-Clause
package dynpoint;

/** What the library refused: its text, and its code. */
public final class DynpointException extends RuntimeException {
    private static final long serialVersionUID = 1;

    /** The code, as in result.h. */
    public final int result;

    /** The code's name, as "DPT_E_HANDLE". */
    public final String name;

    DynpointException(int result, String what, String text) {
        super(what + ": " + (text == null || text.isEmpty() ? Library.text(Abi.dpt_result_text(result)) : text)
            + " (" + Library.text(Abi.dpt_result_name(result)) + ")");
        this.result = result;
        this.name = Library.text(Abi.dpt_result_name(result));
    }
}
