/* alone.c - the header compiles by itself and when included twice, as C99 and as C++11. */
#include "posewise.h"
#include "posewise.h"

posewise_status use_everything(posewise_tracker *t, const posewise_frame *f, posewise_result *r);
posewise_status use_everything(posewise_tracker *t, const posewise_frame *f, posewise_result *r) {
    return posewise_step(t, f, r);
}
